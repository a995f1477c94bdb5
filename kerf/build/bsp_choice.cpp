#include "kerf/build/bsp_choice.h"

#include <algorithm>
#include <cmath>

#include "kerf/base/parallel.h"

namespace kerf {
namespace {

constexpr uint32_t kFewPieces = 8;          // all sides of so many are tried
constexpr uint32_t kParallelCount = 16384;  // fewer pieces are not worth tasks

BspPlane plane_across(uint32_t axis, float position) {
  BspPlane plane;
  plane.normal[axis] = 1;
  plane.offset = position;
  return plane;
}

/// Planes across an axis strictly inside the cell, from low to high.
void add_across(uint32_t axis, const Box3f& cell, const BspPieces& pieces, uint32_t slices,
                std::vector<BspPlane>& planes) {
  std::vector<float> positions;
  if (pieces.size() <= kFewPieces) {
    for (const BspPiece& piece : pieces.list()) {
      positions.push_back(piece.bounds.lower[axis]);
      positions.push_back(piece.bounds.upper[axis]);
    }
  } else {
    const Box3f bounds = pieces.bounds();
    for (uint32_t i = 0; i <= slices; ++i) {
      const float share = static_cast<float>(i) / static_cast<float>(slices);
      positions.push_back(bounds.lower[axis] * (1 - share) + bounds.upper[axis] * share);
    }
  }
  std::sort(positions.begin(), positions.end());
  positions.erase(std::unique(positions.begin(), positions.end()), positions.end());
  for (const float position : positions) {
    if (cell.lower[axis] < position && position < cell.upper[axis]) planes.push_back(plane_across(axis, position));
  }
}

/// The planes of the largest pieces, each once.
void add_faces(const BspPieces& pieces, uint32_t most, std::vector<BspPlane>& planes) {
  std::vector<const BspPiece*> largest;
  for (const BspPiece& piece : pieces.list()) {
    if (piece.count > 0 && !piece.is_flush) largest.push_back(&piece);
  }
  const auto is_larger = [](const BspPiece* a, const BspPiece* b) {
    return a->area != b->area ? a->area > b->area : a->reference < b->reference;
  };
  if (largest.size() > most) {
    std::nth_element(largest.begin(), largest.begin() + most, largest.end(), is_larger);
    largest.resize(most);
  }
  std::sort(largest.begin(), largest.end(), is_larger);
  const auto first = static_cast<std::ptrdiff_t>(planes.size());
  for (const BspPiece* piece : largest) {
    const std::optional<BspPlane> plane = pieces.plane_of(*piece);
    const auto is_same = [&](const BspPlane& p) { return p.normal == plane->normal && p.offset == plane->offset; };
    if (plane && std::none_of(planes.begin() + first, planes.end(), is_same)) planes.push_back(*plane);
  }
}

/// Judges planes for one cell.
class Judge {
 public:
  Judge(const ConvexCell& cell, const BspPieces& pieces, uint64_t most_references, const BspOptions& options)
      : cell_(cell), pieces_(pieces), most_references_(most_references), options_(options) {}

  double cost_of_leaf() const { return options_.primitive_cost * pieces_.size(); }

  /// Infinite where the plane is out of the question, be it because it cannot be cheaper than `best`.
  double cost_of(const BspPlane& plane, double best) const {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    const BspPlane::Kind kind = plane.kind();
    const BspPieces::Counts counts = kind == BspPlane::kOblique
                                         ? pieces_.count(plane)
                                         : pieces_.count_across(kind, static_cast<float>(plane.offset));
    if (uint64_t{counts.below} + counts.above > most_references_) return kNever;
    const double plane_cost = kind == BspPlane::kOblique ? options_.oblique_cost : options_.axis_cost;
    // The parts' areas add up to at least that of the cell.
    const double least = plane_cost + options_.primitive_cost * std::min(counts.below, counts.above);
    if (least >= best) return kNever;
    const ConvexCell::Areas areas = cell_.areas_after(plane);
    if (!(areas.below > 0) || !(areas.above > 0)) return kNever;
    return plane_cost +
           options_.primitive_cost * (areas.below * counts.below + areas.above * counts.above) / cell_.area();
  }

 private:
  const ConvexCell& cell_;
  const BspPieces& pieces_;
  uint64_t most_references_;
  const BspOptions& options_;
};

}  // namespace

std::optional<BspPlane> cheapest_plane(const ConvexCell& cell, const Box3f& cell_bounds, const BspPieces& pieces,
                                       uint64_t most_references, const BspOptions& options) {
  if (pieces.size() == 0 || !(cell.area() > 0)) return std::nullopt;
  std::vector<BspPlane> planes;
  for (uint32_t axis = 0; axis < 3; ++axis) add_across(axis, cell_bounds, pieces, options.slices, planes);
  add_faces(pieces, options.faces, planes);
  const Judge judge(cell, pieces, most_references, options);
  std::vector<double> costs(planes.size());
  if (pieces.size() >= kParallelCount) {
    parallel_for(planes.size(), 1, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) costs[i] = judge.cost_of(planes[i], judge.cost_of_leaf());
    });
  } else {
    double least = judge.cost_of_leaf();
    for (size_t i = 0; i < planes.size(); ++i) least = std::min(least, costs[i] = judge.cost_of(planes[i], least));
  }
  const auto best = std::min_element(costs.begin(), costs.end());
  if (best == costs.end() || !(*best < judge.cost_of_leaf())) return std::nullopt;
  return planes[static_cast<size_t>(best - costs.begin())];
}

}  // namespace kerf
