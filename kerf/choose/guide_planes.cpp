#include "kerf/choose/guide_planes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "kerf/build/reference_order.h"
#include "kerf/build/spatial_bins.h"
#include "kerf/references/box4.h"

namespace kerf {
namespace {

constexpr uint32_t kBins = GuidePlane::kBins;
static_assert(kBins <= SpatialSlices::kMost);
// Planes across a side shorter than this share of the longest are not tried: they leave two long parts, and trees are
// as good without them.
constexpr float kLeastLength = 0.5F;

uint32_t bin_of(float center, float first, float scale) {
  return static_cast<uint32_t>(
      static_cast<int32_t>(std::clamp((center - first) * scale, 0.0F, static_cast<float>(kBins - 1))));
}

/// Slices of a node along one axis: the box of what has its centre there, and how much that is.
struct Line {
  std::array<Box4, kBins> bounds;
  std::array<double, kBins> weights;

  void clear() {
    bounds.fill(Box4::empty());
    weights.fill(0);
  }
};

/// Takes the cheapest place between two slices, if it is cheaper than `best`; returns whether it did.
bool take_cheapest(const Line& line, GuidePlane& best) {
  std::array<Box4, kBins> above;
  std::array<double, kBins> above_weight;
  Box4 box = Box4::empty();
  double weight = 0;
  for (uint32_t i = kBins - 1; i > 0; --i) {
    box.extend(line.bounds[i]);
    weight += line.weights[i];
    above[i] = box;
    above_weight[i] = weight;
  }
  box = Box4::empty();
  weight = 0;
  bool found = false;
  for (uint32_t i = 1; i < kBins; ++i) {
    box.extend(line.bounds[i - 1]);
    weight += line.weights[i - 1];
    if (weight == 0 || above_weight[i] == 0) continue;
    const double cost = box.half_area() * weight + above[i].half_area() * above_weight[i];
    if (!(cost < best.cost)) continue;
    best.cost = cost;
    best.bin = i;
    best.below = box.box();
    best.above = above[i].box();
    best.below_weight = weight;
    best.above_weight = above_weight[i];
    found = true;
  }
  return found;
}

}  // namespace

GuidePlane::Side GuidePlane::side_of(const Box3f& reference, double weight) const {
  const float lower = reference.lower[axis], upper = reference.upper[axis];
  if (!cuts) return bin_of(lower + upper, first, scale) < bin ? Side::below : Side::above;
  if (!(upper > position)) return Side::below;
  if (!(lower < position)) return Side::above;
  const double below_area = half_area(below), above_area = half_area(above);
  const double both = below_area * below_weight + above_area * above_weight;
  const double only_below = half_area(united(below, reference)) * below_weight + above_area * (above_weight - weight);
  const double only_above = below_area * (below_weight - weight) + half_area(united(above, reference)) * above_weight;
  if (std::min(only_below, only_above) > both + toll * weight) return Side::both;
  return only_below <= only_above ? Side::below : Side::above;
}

JudgedBox::JudgedBox(const Judges& judges) {
  Box4 around = Box4::empty(), around_centers = around;
  for (const Reference& reference : judges.references) {
    const Box4 box = Box4::of(reference);
    const Float4 center2 = box.lower + box.upper;
    around.extend(box);
    around_centers.extend({center2, center2});
  }
  bounds = around.box();
  centers = around_centers.box();
  for (const float judge : judges.weights) weight += judge;
  all = bounds;
  for (const Box3f& other : judges.others) all.extend(other);
}

GuidePlane cheapest_dividing_plane(const Judges& judges, const JudgedBox& box) {
  std::array<Line, 3> lines;
  std::array<float, 3> scales;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    lines[axis].clear();
    const float scale = static_cast<float>(kBins) / (box.centers.upper[axis] - box.centers.lower[axis]);
    scales[axis] = std::isfinite(scale) ? scale : 0;  // all centres are in one place, or as good as
  }
  for (size_t i = 0; i < judges.size(); ++i) {
    const Reference& reference = judges.references[i];
    const Box4 bounds = Box4::of(reference);
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const uint32_t bin = bin_of(center2(reference, axis), box.centers.lower[axis], scales[axis]);
      lines[axis].bounds[bin].extend(bounds);
      lines[axis].weights[bin] += judges.weights[i];
    }
  }
  GuidePlane best;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    if (scales[axis] == 0 || !take_cheapest(lines[axis], best)) continue;
    best.axis = axis;
    best.first = box.centers.lower[axis];
    best.scale = scales[axis];
  }
  return best;
}

GuidePlane cheapest_cutting_plane(const Judges& judges, const JudgedBox& box, const Clipper& clipper, double cost) {
  const Vec3f extent = box.bounds.extent();
  // A plane that leaves everything on both sides divides nothing.
  const SpatialLimits limits{2 * box.weight - 1, std::numeric_limits<double>::infinity(), cost};
  SpatialPlane plane;
  // Each axis for itself: together, what was found along one would bound how closely the next is looked at, and the
  // outcome would depend on the order of axes.
  for (uint32_t axis = 0; axis < 3; ++axis) {
    if (extent[axis] < kLeastLength * largest(extent)) continue;
    SpatialSlices slices(box.bounds, kBins);
    for (uint32_t other = 0; other < 3; ++other) {
      if (other != axis) slices.leave_out(other);
    }
    const SpatialPlane along = cheapest_spatial_plane(judges.references, judges.weights, slices, clipper, limits);
    if (along.cost < plane.cost && along.is_found()) plane = along;
  }
  if (!plane.is_found()) return {};
  GuidePlane found;
  found.cost = plane.cost;
  found.cuts = true;
  found.axis = plane.axis;
  found.position = plane.position;
  found.below = plane.below;
  found.above = plane.above;
  found.below_weight = plane.below_count;
  found.above_weight = plane.above_count;
  return found;
}

}  // namespace kerf
