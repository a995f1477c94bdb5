#include "kerf/choose/guide_planes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "kerf/build/reference_order.h"
#include "kerf/choose/slab_bounds.h"

namespace kerf {
namespace {

constexpr uint32_t kBins = GuidePlane::kBins;
static_assert(kBins <= kMostSlabs);
// Planes across a side shorter than this share of the longest are not tried: they leave two long parts, and trees are
// as good without them.
constexpr float kLeastLength = 0.5F;

uint32_t bin_of(float center, float first, float scale) {
  return static_cast<uint32_t>(std::clamp((center - first) * scale, 0.0F, static_cast<float>(kBins - 1)));
}

/// Slices of a node along one axis: the box of each, what begins there and what ends there.
struct Line {
  std::array<Box3f, kBins> bounds;
  std::array<double, kBins> begins{}, ends{};
};

/// Takes the cheapest place between two slices, if it is cheaper than `best`; returns whether it did.
bool take_cheapest(const Line& line, double all, GuidePlane& best) {
  std::array<Box3f, kBins> above;
  std::array<double, kBins> above_weight{};
  Box3f box;
  double weight = 0;
  for (uint32_t i = kBins - 1; i > 0; --i) {
    box.extend(line.bounds[i]);
    weight += line.ends[i];
    above[i] = box;
    above_weight[i] = weight;
  }
  box = {};
  weight = 0;
  bool found = false;
  for (uint32_t i = 1; i < kBins; ++i) {
    box.extend(line.bounds[i - 1]);
    weight += line.begins[i - 1];
    // A plane that leaves everything on both sides divides nothing.
    if (weight == 0 || above_weight[i] == 0 || (weight >= all && above_weight[i] >= all)) continue;
    const double cost = half_area(box) * weight + half_area(above[i]) * above_weight[i];
    if (!(cost < best.cost)) continue;
    best.cost = cost;
    best.bin = i;
    best.below = box;
    best.above = above[i];
    best.below_weight = weight;
    best.above_weight = above_weight[i];
    found = true;
  }
  return found;
}

}  // namespace

bool GuidePlane::is_below(const Reference& reference) const {
  return bin_of(center2(reference, axis), first, scale) < bin;
}

GuideNode::GuideNode(std::span<const GuidedReference> references) {
  for (const GuidedReference& guided : references) {
    bounds.extend(guided.reference.bounds());
    if (guided.weight == 0) continue;
    centers.extend(guided.reference.lower + guided.reference.upper);
    weight += guided.weight;
    ++weighty;
  }
}

GuidePlane cheapest_dividing_plane(std::span<const GuidedReference> references, const GuideNode& node) {
  GuidePlane best;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const float first = node.centers.lower[axis];
    const float scale = static_cast<float>(kBins) / (node.centers.upper[axis] - first);
    if (!(scale > 0 && std::isfinite(scale))) continue;
    Line line;
    for (const GuidedReference& guided : references) {
      if (guided.weight == 0) continue;
      const uint32_t bin = bin_of(center2(guided.reference, axis), first, scale);
      line.bounds[bin].extend(guided.reference.bounds());
      line.begins[bin] += guided.weight;
    }
    line.ends = line.begins;
    if (!take_cheapest(line, node.weight, best)) continue;
    best.axis = axis;
    best.first = first;
    best.scale = scale;
  }
  return best;
}

GuidePlane cheapest_cutting_plane(std::span<const GuidedReference> references, const GuideNode& node,
                                  std::span<const Geometry> geometries) {
  GuidePlane best;
  const float longest = largest(node.bounds.extent());
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const Slabs slabs(node.bounds, axis, kBins);
    if (!slabs.is_usable() || slabs.extent < kLeastLength * longest) continue;
    Line line;
    for (const GuidedReference& guided : references) {
      if (guided.weight == 0) continue;
      const uint32_t begin = slabs.slab_of(guided.reference.lower[axis]);
      const uint32_t end = slabs.slab_of(guided.reference.upper[axis]);
      line.begins[begin] += guided.weight;
      line.ends[end] += guided.weight;
      if (begin == end) {
        line.bounds[begin].extend(guided.reference.bounds());
      } else {
        extend_by_parts(geometries, guided.reference, slabs, begin, end, line.bounds.data());
      }
    }
    if (!take_cheapest(line, node.weight, best)) continue;
    best.axis = axis;
    best.cuts = true;
    best.position = slabs.plane(best.bin);
  }
  return best;
}

}  // namespace kerf
