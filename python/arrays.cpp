#include "python/arrays.h"

#include <pybind11/stl.h>

#include <limits>

#include "kerf/base/error.h"
#include "kerf/geometry/hit.h"

namespace kerf::python {
namespace {

/// numpy.asarray(given), whose numbers must be of one of the kinds (numpy's letters: f, i, u).
py::array to_array(const py::object& given, const char* name, const std::string& kinds, const char* what) {
  py::array array = py::module_::import("numpy").attr("asarray")(given);
  // An empty list has no numbers, so numpy's guess at their type means nothing.
  if (array.size() > 0 && kinds.find(array.dtype().kind()) == std::string::npos) {
    refuse(name, std::string(what) + " are expected, not " + py::str(array.dtype()).cast<std::string>());
  }
  return array;
}

std::string shape_text(const py::array& array) { return py::str(array.attr("shape")).cast<std::string>(); }

}  // namespace

void refuse(const std::string& place, const std::string& sentence) {
  throw Error(ErrorCode::invalid_argument, place, sentence);
}

py::array_t<float> to_floats(const py::object& given, const char* name) {
  return py::array_t<float>(to_array(given, name, "fiu", "numbers"));
}

void check_rows(const py::array& rows, const char* name) {
  const bool empty = rows.size() == 0 && (rows.ndim() == 1 || (rows.ndim() == 2 && rows.shape(1) == 3));
  if (!empty && (rows.ndim() != 2 || rows.shape(1) != 3))
    refuse(name, "shape (n, 3) is expected, not " + shape_text(rows));
}

py::array_t<uint32_t> to_faces(const py::object& given, bool skip_invalid) {
  const py::array faces = to_array(given, "faces", "iu", "integers");
  check_rows(faces, "faces");
  if (faces.size() == 0 || py::isinstance<py::array_t<uint32_t>>(faces)) {
    return py::array_t<uint32_t>(faces);
  }
  // Numbers from 2^63 become negative here: bad either way.
  const py::array_t<int64_t, py::array::c_style | py::array::forcecast> wide(faces);
  py::array_t<uint32_t> narrow({wide.shape(0), py::ssize_t{3}});
  for (py::ssize_t i = 0; i < wide.size(); ++i) {
    const int64_t number = wide.data()[i];
    const bool fits = number >= 0 && number <= std::numeric_limits<uint32_t>::max();
    if (!fits && !skip_invalid) {
      const std::string text = py::str(faces.attr("item")(i)).cast<std::string>();
      throw Error(ErrorCode::invalid_geometry, "faces, row " + std::to_string(i / 3),
                  "vertex number " + text + " is out of range (skip_invalid drops such faces)");
    }
    narrow.mutable_data()[i] = fits ? static_cast<uint32_t>(number) : kNone;
  }
  return narrow;
}

Rays::Rays(const py::object& origins, const py::object& directions, const py::object& t_min, const py::object& t_max)
    : columns{to_floats(origins, "origins"), to_floats(directions, "directions"), to_floats(t_min, "t_min"),
              to_floats(t_max, "t_max")} {
  const py::module_ numpy = py::module_::import("numpy");
  std::array<py::tuple, 4> shapes;
  for (size_t k = 0; k < 4; ++k) {
    const py::array& column = columns[k];
    const py::ssize_t dimensions = column.ndim() - (k < 2 ? 1 : 0);
    if (k < 2 && (dimensions < 0 || column.shape(dimensions) != 3)) {
      refuse(k == 0 ? "origins" : "directions", "shape (n, 3) or (3,) is expected, not " + shape_text(column));
    }
    shapes[k] = py::tuple(py::cast(std::vector<py::ssize_t>(column.shape(), column.shape() + dimensions)));
  }
  try {
    shape = numpy.attr("broadcast_shapes")(*py::cast(shapes)).cast<std::vector<py::ssize_t>>();
  } catch (const py::error_already_set& error) {
    if (!error.matches(PyExc_ValueError)) throw;
    refuse("rays", "the shapes of origins, directions, t_min and t_max do not fit together: " + shape_text(columns[0]) +
                       ", " + shape_text(columns[1]) + ", " + shape_text(columns[2]) + ", " + shape_text(columns[3]));
  }
  for (const py::ssize_t length : shape) count *= length;
  for (size_t k = 0; k < 4; ++k) {
    std::vector<py::ssize_t> full = shape, rows = {count};
    if (k < 2) full.push_back(3), rows.push_back(3);
    columns[k] = numpy.attr("broadcast_to")(columns[k], full).attr("reshape")(rows);
  }
}

}  // namespace kerf::python
