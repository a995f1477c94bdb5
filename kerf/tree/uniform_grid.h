#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "kerf/tree/bvh.h"
#include "kerf/tree/cell_cut.h"

namespace kerf {

/// A box divided into cells of equal size, each with the primitives that reach into it. Cells are closed and share
/// their sides exactly: the planes between them are numbers that all who ask read. Owns no geometry.
struct UniformGrid {
  using Cell = std::array<uint32_t, 3>;  ///< its place along each axis

  std::array<std::vector<float>, 3>
      planes;                     ///< of each axis, one more than cells along it, not decreasing; no cells: nothing
  std::vector<uint32_t> offsets;  ///< cell i has the slots [offsets[i], offsets[i + 1])
  std::vector<LeafSlot> slots;    ///< of each cell, by geometry, then primitive

  bool is_empty() const { return offsets.empty(); }
  uint32_t resolution(uint32_t axis) const { return static_cast<uint32_t>(planes[axis].size()) - 1; }
  size_t cell_count() const { return offsets.empty() ? 0 : offsets.size() - 1; }
  /// The number of a cell: those along x lie beside each other.
  size_t number(const Cell& c) const { return (size_t{c[2]} * resolution(kY) + c[1]) * resolution(kX) + c[0]; }
  Cell cell(size_t number) const;
  Box3f bounds() const;
  Box3f cell_bounds(const Cell& c) const;
  std::span<const LeafSlot> slots_of(size_t number) const {
    return {slots.data() + offsets[number], offsets[number + 1] - offsets[number]};
  }
  size_t bytes() const;
};

/// Planes for about `cells` cells of about equal sides, never more than `cells` or 1; no axis has less than 1 cell, so
/// flat and elongated boxes are divided along their long sides.
void divide(UniformGrid& grid, const Box3f& bounds, double cells);

/// The cells [first, last] along each axis that a box within the grid reaches into. Where it only touches a plane from
/// above, the cell below is not among them, and so for those above; all of the box lies in them nevertheless.
struct CellRange {
  UniformGrid::Cell first, last;
};
CellRange range_of(const UniformGrid& grid, const Box3f& box);

/// Calls emit(number) for every cell that something within `box` reaches into, until it returns false. What that is
/// only `cut` knows: of what lies in a box it returns the CutBoxes at a plane that crosses the box.
template <class Cut, class Emit>
void for_each_cell(const UniformGrid& grid, const Box3f& whole, Cut&& cut, Emit&& emit) {
  Box3f stack[64];  // a cut halves the cells along one axis, so at most 3 * 17 wait
  uint32_t waiting = 0;
  stack[waiting++] = whole;
  while (waiting > 0) {
    const Box3f box = stack[--waiting];
    const CellRange range = range_of(grid, box);
    uint32_t axis = 0, most = 0;
    for (uint32_t a = 0; a < 3; ++a) {
      const uint32_t steps = range.last[a] - range.first[a];
      if (steps > most) {
        most = steps;
        axis = a;
      }
    }
    if (most == 0) {
      if (!emit(grid.number(range.first))) return;
      continue;
    }
    const float position = grid.planes[axis][range.first[axis] + (most + 1) / 2];
    const CutBoxes parts = settled(cut(box, axis, position), box, axis, position);
    if (!parts.above.is_empty()) stack[waiting++] = parts.above;
    if (!parts.below.is_empty()) stack[waiting++] = parts.below;
  }
}

/// A number that is equal for equal grids, whatever the machine.
uint64_t tree_hash(const UniformGrid& grid);

/// What is wrong with the grid, if anything: planes that decrease or hold less than the primitives, offsets or slots
/// out of range, a primitive missing in a cell that it reaches into or standing in one that its box does not touch,
/// slots out of order, a wrong kRepeated.
std::optional<std::string> find_fault(const UniformGrid& grid, std::span<const Geometry> geometries);

}  // namespace kerf
