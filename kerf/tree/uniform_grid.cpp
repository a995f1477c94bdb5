#include "kerf/tree/uniform_grid.h"

#include <algorithm>
#include <cmath>

#include "kerf/tree/cell_slots.h"

namespace kerf {
namespace {

constexpr double kMostAlongAxis = 65536;

/// Cells along each axis. Axes too short for one whole cell get one, and the others share what is allowed.
UniformGrid::Cell resolution_for(const Box3f& bounds, double cells) {
  const Vec3d extent = to_double(bounds.upper) - to_double(bounds.lower);
  UniformGrid::Cell result{1, 1, 1};
  bool divided[3] = {extent.x > 0, extent.y > 0, extent.z > 0};
  for (int round = 0; round < 3; ++round) {
    int axes = 0;
    double logarithm = 0;  // of the volume, because sides of 1e-45 and 1e36 must do
    for (uint32_t a = 0; a < 3; ++a) {
      if (!divided[a]) continue;
      ++axes;
      logarithm += std::log2(extent[a]);
    }
    if (axes == 0) break;
    const double per_unit = (std::log2(std::max(cells, 1.0)) - logarithm) / axes;
    bool fits = true;
    for (uint32_t a = 0; a < 3; ++a) {
      if (!divided[a]) continue;
      const double along = std::exp2(std::log2(extent[a]) + per_unit);
      result[a] = static_cast<uint32_t>(std::clamp(along, 1.0, kMostAlongAxis));
      if (along < 1) {
        divided[a] = false;
        fits = false;
      }
    }
    if (fits) break;
  }
  return result;
}

/// The first plane that decreases or is not a number, or what else an axis can lack.
std::optional<std::string> find_plane_fault(const UniformGrid& grid) {
  size_t cells = 1;
  for (const std::vector<float>& planes : grid.planes) {
    if (planes.size() < 2) return "an axis without cells";
    for (size_t i = 0; i < planes.size(); ++i) {
      if (!std::isfinite(planes[i])) return "a plane that is no finite number";
      if (i > 0 && planes[i] < planes[i - 1]) return "planes that decrease";
    }
    cells *= planes.size() - 1;
  }
  if (grid.cell_count() != cells) return "planes and offsets for different numbers of cells";
  if (grid.offsets.front() != 0 || grid.offsets.back() != grid.slots.size()) return "offsets that miss slots";
  if (!std::is_sorted(grid.offsets.begin(), grid.offsets.end())) return "offsets that decrease";
  return std::nullopt;
}

bool in_order(const LeafSlot& a, const LeafSlot& b) {
  return a.geometry() != b.geometry() ? a.geometry() < b.geometry() : a.primitive < b.primitive;
}

std::optional<std::string> find_cell_fault(const UniformGrid& grid, std::span<const Geometry> geometries,
                                           size_t number) {
  const Box3f bounds = grid.cell_bounds(grid.cell(number));
  const std::span<const LeafSlot> slots = grid.slots_of(number);
  for (size_t i = 0; i < slots.size(); ++i) {
    const Box3f box = primitive_bounds(geometries[slots[i].geometry()], slots[i].primitive);
    if (intersected(box, bounds).is_empty()) return "holds a primitive that is elsewhere";
    if (i > 0 && !in_order(slots[i - 1], slots[i])) return "has slots out of order";
  }
  return std::nullopt;
}

/// Whether the primitive stands in every cell that it reaches into.
bool is_complete(const UniformGrid& grid, std::span<const Geometry> geometries, uint32_t g, uint32_t p) {
  const auto cut = [&](const Box3f& box, uint32_t axis, float position) {
    const CutBoxes parts = halves(box, axis, position);
    return CutBoxes{clipped_bounds(geometries[g], p, parts.below), clipped_bounds(geometries[g], p, parts.above)};
  };
  bool complete = true;
  for_each_cell(grid, primitive_bounds(geometries[g], p), cut, [&](size_t number) {
    const std::span<const LeafSlot> slots = grid.slots_of(number);
    complete = std::binary_search(slots.begin(), slots.end(), LeafSlot{g, p}, in_order);
    return complete;
  });
  return complete;
}

}  // namespace

UniformGrid::Cell UniformGrid::cell(size_t number) const {
  const size_t row = number / resolution(kX);
  return {static_cast<uint32_t>(number % resolution(kX)), static_cast<uint32_t>(row % resolution(kY)),
          static_cast<uint32_t>(row / resolution(kY))};
}

Box3f UniformGrid::bounds() const {
  if (is_empty()) return {};
  return {{planes[0].front(), planes[1].front(), planes[2].front()},
          {planes[0].back(), planes[1].back(), planes[2].back()}};
}

Box3f UniformGrid::cell_bounds(const Cell& c) const {
  return {{planes[0][c[0]], planes[1][c[1]], planes[2][c[2]]},
          {planes[0][c[0] + 1], planes[1][c[1] + 1], planes[2][c[2] + 1]}};
}

size_t UniformGrid::bytes() const {
  size_t bytes = offsets.size() * sizeof(uint32_t) + slots.size() * sizeof(LeafSlot);
  for (const std::vector<float>& axis : planes) bytes += axis.size() * sizeof(float);
  return bytes;
}

void divide(UniformGrid& grid, const Box3f& bounds, double cells) {
  const UniformGrid::Cell resolution = resolution_for(bounds, cells);
  for (uint32_t a = 0; a < 3; ++a) {
    std::vector<float>& planes = grid.planes[a];
    planes.resize(size_t{resolution[a]} + 1);
    const double lower = bounds.lower[a], step = (double{bounds.upper[a]} - lower) / resolution[a];
    for (uint32_t i = 0; i < resolution[a]; ++i) planes[i] = static_cast<float>(lower + step * i) + 0.0F;
    planes.front() = bounds.lower[a];
    planes.back() = bounds.upper[a];
  }
}

CellRange range_of(const UniformGrid& grid, const Box3f& box) {
  CellRange range;
  for (uint32_t a = 0; a < 3; ++a) {
    const std::vector<float>& planes = grid.planes[a];
    const auto begin = planes.begin() + 1, end = planes.end() - 1;  // the inner planes
    const auto above_lower = std::upper_bound(begin, end, box.lower[a]);
    const auto at_upper = std::lower_bound(above_lower, end, box.upper[a]);
    range.first[a] = static_cast<uint32_t>(above_lower - begin);
    range.last[a] = static_cast<uint32_t>(at_upper - begin);
  }
  return range;
}

uint64_t tree_hash(const UniformGrid& grid) {
  uint64_t hash = data_hash(std::span(grid.offsets), data_hash(std::span(grid.slots)));
  for (const std::vector<float>& planes : grid.planes) hash = data_hash(std::span(planes), hash);
  return hash;
}

std::optional<std::string> find_fault(const UniformGrid& grid, std::span<const Geometry> geometries) {
  if (auto fault = find_slot_fault(grid.slots, geometries)) return fault;
  if (grid.is_empty()) return grid.slots.empty() ? std::nullopt : std::optional<std::string>("slots without cells");
  if (auto fault = find_plane_fault(grid)) return fault;
  for (size_t number = 0; number < grid.cell_count(); ++number) {
    if (auto fault = find_cell_fault(grid, geometries, number)) return "cell " + std::to_string(number) + " " + *fault;
  }
  for (uint32_t g = 0; g < geometries.size(); ++g) {
    for (uint32_t p = 0; p < primitive_count(geometries[g]); ++p) {
      if (find_defect(geometries[g], p) != Defect::none || is_degenerate(geometries[g], p)) continue;
      const std::string name = "geometry " + std::to_string(g) + ", primitive " + std::to_string(p);
      if (!grid.bounds().contains(primitive_bounds(geometries[g], p))) return name + " reaches out of the grid";
      if (!is_complete(grid, geometries, g, p)) return name + " is missing in a cell that it reaches into";
    }
  }
  return std::nullopt;
}

}  // namespace kerf
