#include "kerf/layout/wide_collapse.h"

#include <algorithm>
#include <cassert>
#include <string>
#include <variant>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"

namespace kerf {
namespace {

constexpr uint32_t kTaskDepth = 10;

}  // namespace

WideCollapse::WideCollapse(const Bvh& bvh, std::span<const Geometry> geometries, uint32_t width, const WideCosts& costs,
                           uint32_t most, LeafUnits leaf_units, const char* name)
    : bvh_(bvh),
      geometries_(geometries),
      width_(width),
      costs_(costs),
      most_(most),
      leaf_units_(leaf_units),
      name_(name),
      held_(bvh.nodes.size() * sizeof(Plan)) {
  assert(width >= 2 && width <= kMostChildren && most <= kMostNumbers);
  plans_.resize(bvh.nodes.size());
  only_triangles_ = std::all_of(geometries.begin(), geometries.end(), [](const Geometry& geometry) {
    return std::holds_alternative<TriangleMesh>(geometry.shapes);
  });
  const double root = half_area(bvh.nodes[0].bounds());
  scale_ = root > 0 ? 1 / root : 0;
  cost_ = solve(0, 0)[0];
  measure(0, 0);
}

bool WideCollapse::are_triangles(uint32_t node) const {
  if (only_triangles_) return true;
  const std::span<const LeafSlot> slots = std::span(bvh_.slots).subspan(bvh_.nodes[node].first, bvh_.nodes[node].count);
  return std::all_of(slots.begin(), slots.end(), [&](const LeafSlot& slot) {
    return std::holds_alternative<TriangleMesh>(geometries_[slot.geometry()].shapes);
  });
}

WideCollapse::Costs WideCollapse::solve(uint32_t node, uint32_t depth) {
  const BvhNode& n = bvh_.nodes[node];
  if (n.is_leaf()) return solve_leaf(node);
  Costs a, b;
  if (depth < kTaskDepth) {
    parallel_invoke([&] { a = solve(n.first, depth + 1); }, [&] { b = solve(n.first + 1, depth + 1); });
  } else {
    a = solve(n.first, depth + 1);
    b = solve(n.first + 1, depth + 1);
  }
  return solve_inner(node, a, b);
}

WideCollapse::Costs WideCollapse::solve_leaf(uint32_t node) {
  Plan& plan = plans_[node];
  const BvhNode& n = bvh_.nodes[node];
  FewSlots slots;
  const uint32_t count = are_triangles(node) ? gather(node, slots, 0) : TriangleLeaf::kMost + 1;
  const bool fits = count <= TriangleLeaf::kMost;
  plan.set_leaf();
  if (fits) plan.set_slots(count);
  const auto all = std::span(bvh_.slots).subspan(n.first, n.count);
  if (std::any_of(all.begin(), all.end(), [](const LeafSlot& slot) { return slot.is_repeated(); })) plan.set_repeated();
  const double cost = fits ? costs_.leaf + costs_.triangle * count : costs_.primitive * n.count;
  Costs costs;
  costs.fill(static_cast<float>(scale_ * half_area(n.bounds()) * cost));
  return costs;
}

WideCollapse::Costs WideCollapse::solve_inner(uint32_t node, const Costs& a, const Costs& b) {
  Plan& plan = plans_[node];
  const BvhNode& n = bvh_.nodes[node];
  Costs divided;                                // the cheapest of i + 1 subtrees, at least one in each child
  std::array<uint32_t, kMostChildren> first{};  // how many of them the first child gets
  for (uint32_t i = 1; i < width_; ++i) {
    float least = a[0] + b[i - 1];
    uint32_t gets = 1;
    for (uint32_t k = 1; k < i; ++k) {
      const float cost = a[k] + b[i - 1 - k];
      const uint32_t is_less = cost < least ? ~0U : 0;  // no branch: it would be foreseen every second time
      least = cost < least ? cost : least;
      gets ^= (gets ^ (k + 1)) & is_less;
    }
    divided[i] = least;
    first[i] = gets;
  }
  const double area = scale_ * half_area(n.bounds());
  // As an inner node, whose own children divide the full width; as a leaf if all fit.
  Costs costs;
  plan.set_first(0, first[width_ - 1]);
  costs[0] = static_cast<float>(area * costs_.node) + divided[width_ - 1];
  const Plan &left = plans_[n.first], &right = plans_[n.first + 1];
  if (left.slots() > 0 && right.slots() > 0) {
    const bool is_repeated = left.is_repeated() && right.is_repeated();  // else no slot of one can be in the other
    FewSlots slots;
    const uint32_t count = is_repeated ? gather(node, slots, 0) : left.slots() + right.slots();
    if (left.is_repeated() || right.is_repeated()) plan.set_repeated();
    const auto cost = static_cast<float>(area * (costs_.leaf + costs_.triangle * count));
    if (count <= TriangleLeaf::kMost) {
      plan.set_slots(count);
      if (cost <= costs[0]) {
        plan.set_leaf();
        costs[0] = cost;
      }
    }
  }
  for (uint32_t i = 1; i < width_; ++i) {
    // Of equals the more subtrees: they make fewer nodes, also where nothing has an area.
    const bool is_better = divided[i] <= costs[i - 1];
    if (is_better) plan.set_first(i, first[i]);
    costs[i] = is_better ? divided[i] : costs[i - 1];
  }
  return costs;
}

/// The different primitives of a subtree of triangles; more than kMost where there are more.
uint32_t WideCollapse::gather(uint32_t node, FewSlots& slots, uint32_t count) const {
  const BvhNode& n = bvh_.nodes[node];
  if (!n.is_leaf()) {
    count = gather(n.first, slots, count);
    return count > TriangleLeaf::kMost ? count : gather(n.first + 1, slots, count);
  }
  for (uint32_t i = n.first; i < n.first + n.count; ++i) {
    const LeafSlot& slot = bvh_.slots[i];
    const auto end = slots.begin() + count;
    if (slot.is_repeated() && std::find(slots.begin(), end, slot) != end) continue;
    if (count == TriangleLeaf::kMost) return count + 1;
    slots[count++] = slot;
  }
  return count;
}

void WideCollapse::collect(uint32_t node, uint32_t most, Children& children, uint32_t& count) const {
  const Plan& plan = plans_[node];
  while (most > 1 && plan.first(most - 1) == 0) --most;
  if (most == 1) {
    children[count++] = node;
    return;
  }
  const uint32_t first = plan.first(most - 1);
  collect(bvh_.nodes[node].first, first, children, count);
  collect(bvh_.nodes[node].first + 1, most - first, children, count);
}

uint32_t WideCollapse::children(uint32_t node, Children& children) const {
  assert(!is_leaf(node));
  const uint32_t first = plans_[node].first(0);
  uint32_t count = 0;
  collect(bvh_.nodes[node].first, first, children, count);
  collect(bvh_.nodes[node].first + 1, width_ - first, children, count);
  // The largest first, equal ones as they stand.
  std::array<double, kMostChildren> areas;
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t child = children[i];
    const double area = half_area(bvh_.nodes[child].bounds());
    uint32_t place = i;
    for (; place > 0 && areas[place - 1] < area; --place) {
      areas[place] = areas[place - 1];
      children[place] = children[place - 1];
    }
    areas[place] = area;
    children[place] = child;
  }
  return count;
}

std::span<const LeafSlot> WideCollapse::leaf_slots(uint32_t node, FewSlots& few) const {
  const BvhNode& n = bvh_.nodes[node];
  if (!is_triangles(node)) return std::span(bvh_.slots).subspan(n.first, n.count);
  return std::span(few).first(gather(node, few, 0));
}

size_t WideCollapse::units_of_leaf(uint32_t node) const {
  if (!is_triangles(node)) return slots_units(bvh_.nodes[node].count);
  if (leaf_units_ == nullptr) return TriangleLeaf::units(plans_[node].slots());
  FewSlots few;
  return leaf_units_(leaf_slots(node, few), geometries_);
}

void WideCollapse::measure(uint32_t node, uint32_t depth) {
  Plan& plan = plans_[node];
  if (plan.is_leaf()) {
    plan.size.units = static_cast<uint32_t>(units_of_leaf(node));
    return;
  }
  Children all;
  const uint32_t count = children(node, all);
  const auto some = [&](uint32_t begin, uint32_t end) {
    for (uint32_t i = begin; i < end; ++i) measure(all[i], depth + 1);
  };
  if (depth < kTaskDepth / 2) {
    parallel_invoke([&] { some(0, count / 2); }, [&] { some(count / 2, count); });
  } else {
    some(0, count);
  }
  plan.size.nodes = 1;
  for (uint32_t i = 0; i < count; ++i) {
    plan.size.nodes += plans_[all[i]].size.nodes;
    plan.size.units += plans_[all[i]].size.units;
  }
  // Of eight children that are not too large each the sum fits its number.
  if (plan.size.nodes <= most_ && plan.size.units <= most_) return;
  throw Error(ErrorCode::too_large, name_ + std::to_string(width_),
              std::to_string(bvh_.slots.size()) + " references are too many for it; bvh2 takes them");
}

}  // namespace kerf
