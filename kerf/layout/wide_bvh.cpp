#include "kerf/layout/wide_bvh.h"

#include <algorithm>

#include "kerf/layout/wide_check.h"
#include "kerf/layout/wide_writer.h"
#include "kerf/tree/hash_values.h"

namespace kerf {
namespace {

/// See WideCheck.
template <uint32_t kWidth>
struct Rules {
  using Layout = WideBvh<kWidth>;

  static Box3f box_of(const Box3f&, const Box3f& child) { return child; }

  static bool is_around(const Layout&, const WideNode<kWidth>& node, const Box3f& box) {
    Box3f all;
    for (uint32_t i = 0; i < kWidth; ++i) {
      if (node.has_child(i)) all.extend(node.bounds(i));
    }
    return box == all;
  }

  static size_t leaf_units(const Layout&, WideChild leaf) {
    return leaf.kind() <= TriangleLeaf::kMost ? TriangleLeaf::units(leaf.kind()) : 0;
  }

  static bool is_written(const Layout& layout, std::span<const Geometry> geometries, WideChild leaf,
                         std::span<const LeafSlot> slots) {
    std::vector<LeafUnit> expected(TriangleLeaf::units(slots.size()));
    write_triangle_leaf(slots, geometries, expected.data());
    const size_t bytes = sizeof(float) * TriangleLeaf::kFloats * slots.size();
    return std::memcmp(expected.data(), &layout.leaves[leaf.number()], bytes) == 0;
  }
};

}  // namespace

template <uint32_t kWidth>
void WideNode<kWidth>::set_bounds(std::span<const Box3f> boxes) {
  for (auto& of_axis : sides) {
    std::fill_n(of_axis[0], kWidth, Box3f::kInfinity);
    std::fill_n(of_axis[1], kWidth, -Box3f::kInfinity);
  }
  for (uint32_t i = 0; i < boxes.size(); ++i) set_bounds(i, boxes[i]);
}

template <uint32_t kWidth>
void WideBvh<kWidth>::read_slots(WideChild leaf, std::vector<LeafSlot>& to) const {
  const LeafUnit* unit = &leaves[leaf.number()];
  if (leaf.kind() == WideChild::kSlots) return kerf::read_slots(unit, to);
  to.resize(leaf.kind());
  std::memcpy(static_cast<void*>(to.data()), unit->values + 9 * to.size(), to.size() * sizeof(LeafSlot));
}

template <uint32_t kWidth>
std::vector<LeafSlot> WideBvh<kWidth>::slots(WideChild leaf) const {
  std::vector<LeafSlot> slots;
  read_slots(leaf, slots);
  return slots;
}

template <uint32_t kWidth>
WideChild WideBvh<kWidth>::write_leaf(std::span<const LeafSlot> slots, bool is_triangles,
                                      std::span<const Geometry> geometries, size_t unit) {
  if (is_triangles) {
    write_triangle_leaf(slots, geometries, &leaves[unit]);
    return WideChild::of(static_cast<uint32_t>(slots.size()), unit);
  }
  write_slots(slots, &leaves[unit]);
  return WideChild::of(WideChild::kSlots, unit);
}

template <uint32_t kWidth>
WideBvh<kWidth> make_wide_bvh(const Bvh& bvh, std::span<const Geometry> geometries, const WideCosts& costs,
                              LeafNumbers* numbers) {
  WideBvh<kWidth> layout;
  if (bvh.nodes.empty()) return layout;
  const WideCollapse collapse(bvh, geometries, kWidth, costs);
  write_wide(layout, bvh, geometries, collapse, numbers);
  return layout;
}

template <uint32_t kWidth>
std::optional<std::string> find_fault(const WideBvh<kWidth>& layout, std::span<const Geometry> geometries) {
  return WideCheck(layout, geometries, Rules<kWidth>()).run();
}

template <uint32_t kWidth>
uint64_t tree_hash(const WideBvh<kWidth>& layout) {
  if (layout.is_empty()) return 0;
  return hash_values(hash_values(layout.root.word, layout.nodes.span()), layout.leaves.span());
}

#define KERF_INSTANTIATE(width)                                                                                        \
  template void WideNode<width>::set_bounds(std::span<const Box3f>);                                                   \
  template WideChild WideBvh<width>::write_leaf(std::span<const LeafSlot>, bool, std::span<const Geometry>, size_t);   \
  template std::vector<LeafSlot> WideBvh<width>::slots(WideChild) const;                                               \
  template void WideBvh<width>::read_slots(WideChild, std::vector<LeafSlot>&) const;                                   \
  template WideBvh<width> make_wide_bvh<width>(const Bvh&, std::span<const Geometry>, const WideCosts&, LeafNumbers*); \
  template std::optional<std::string> find_fault<width>(const WideBvh<width>&, std::span<const Geometry>);             \
  template uint64_t tree_hash<width>(const WideBvh<width>&);
KERF_INSTANTIATE(4)
KERF_INSTANTIATE(8)
#undef KERF_INSTANTIATE

}  // namespace kerf
