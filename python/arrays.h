// numpy's arrays as Kerf reads them, in place where their memory allows it. What does not fit is an Error with the
// argument's name.

#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "kerf/geometry/ray.h"
#include "kerf/geometry/shapes.h"

namespace kerf::python {

namespace py = pybind11;

/// Throws Error(invalid_argument).
[[noreturn]] void refuse(const std::string& place, const std::string& sentence);

/// numpy.asarray(given), of numbers.
py::array_t<float> to_floats(const py::object& given, const char* name);

/// Refuses what is neither of shape (n, 3) nor empty. A single (3,) is refused too: one vertex or face is no mesh.
void check_rows(const py::array& rows, const char* name);

/// The faces as vertex numbers of 32 bits. Numbers that do not fit are an error, or with `skip_invalid` become one that
/// no mesh has, so that the face is dropped and counted like every other one with a bad index.
py::array_t<uint32_t> to_faces(const py::object& given, bool skip_invalid);

/// The rows of an array as Kerf reads them, in place. `array` is replaced by a packed copy where its memory does not
/// do: the three numbers of a row must lie side by side, rows may be any distance apart, forwards.
template <class Row, class T>
Strided<Row> to_strided(py::array_t<T>& array) {
  if (array.size() == 0) return {};
  if (array.strides(1) != sizeof(T) || array.strides(0) < 0) array = py::array_t<T, py::array::c_style>(array);
  return {array.data(), static_cast<size_t>(array.shape(0)), static_cast<size_t>(array.strides(0))};
}

/// Rays as strided columns, and the shape that results have: what is common to all four after numpy's broadcasting.
struct Rays {
  std::array<py::array_t<float>, 4> columns;  ///< origins, directions (n, 3); t_min, t_max (n,)
  std::vector<py::ssize_t> shape;
  py::ssize_t count = 1;

  Rays(const py::object& origins, const py::object& directions, const py::object& t_min, const py::object& t_max);

  /// Any stride and any alignment, without a look at Python.
  float at(size_t column, py::ssize_t row, py::ssize_t component = 0) const {
    const py::array& array = columns[column];
    const py::ssize_t within = column < 2 ? component * array.strides(1) : 0;
    float value = 0;
    std::memcpy(&value, static_cast<const char*>(array.data()) + row * array.strides(0) + within, sizeof(value));
    return value;
  }
  Ray operator[](py::ssize_t i) const {
    return {.origin = {at(0, i, 0), at(0, i, 1), at(0, i, 2)},
            .t_min = at(2, i),
            .direction = {at(1, i, 0), at(1, i, 1), at(1, i, 2)},
            .t_max = at(3, i)};
  }
};

}  // namespace kerf::python
