#include "kerf/tree/kd_tree.h"

#include <algorithm>
#include <utility>

#include "kerf/base/mix.h"

namespace kerf {
namespace {

std::string at(const char* what, size_t number) { return std::string(what) + " " + std::to_string(number); }

/// A primitive's number among all of the scene.
uint64_t name_of(const LeafSlot& slot) { return uint64_t{slot.geometry()} << 32 | slot.primitive; }

/// A primitive, or what of it lies in a cell, on its way down the tree.
struct Item {
  uint64_t name;
  Box3f box;

  uint32_t geometry() const { return static_cast<uint32_t>(name >> 32); }
  uint32_t primitive() const { return static_cast<uint32_t>(name); }
};

class Checker {
 public:
  Checker(const KdTree& tree, std::span<const Geometry> geometries, bool boxes_only, uint32_t max_depth)
      : tree_(tree), geometries_(geometries), boxes_only_(boxes_only), max_depth_(max_depth) {}

  std::optional<std::string> find() {
    if (tree_.is_empty()) {
      if (!tree_.slots.empty()) return "slots without nodes";
      return std::nullopt;
    }
    if (!check_slots() || !check_links()) return fault_;
    place_slots();
    std::vector<Item> items;
    for (size_t i = 0; i < places_.size(); ++i) {
      if (i > 0 && places_[i].first == places_[i - 1].first) continue;
      const Item item{places_[i].first, {}};
      items.push_back({item.name, primitive_bounds(geometries_[item.geometry()], item.primitive())});
    }
    check_cell(0, tree_.bounds, std::move(items));
    return fault_;
  }

 private:
  bool fail(const std::string& text) {
    if (!fault_) fault_ = text;
    return false;
  }

  bool check_slots() {
    for (size_t i = 0; i < tree_.slots.size(); ++i) {
      const LeafSlot& slot = tree_.slots[i];
      if (slot.geometry() >= geometries_.size() || slot.primitive >= primitive_count(geometries_[slot.geometry()])) {
        return fail(at("slot", i) + " names no primitive");
      }
    }
    KdTree marked = tree_;
    mark_repeated(marked, geometries_);
    const auto wrong = std::mismatch(tree_.slots.begin(), tree_.slots.end(), marked.slots.begin()).first;
    if (wrong == tree_.slots.end()) return true;
    return fail(at("slot", wrong - tree_.slots.begin()) + " has the wrong repeat mark");
  }

  /// Nodes and slots must come in the very order of a walk through the tree, so each is reached once.
  bool check_links() {
    uint32_t next_slot = 0, next_node = 0;
    first_slot_.resize(tree_.nodes.size());
    struct Place {
      uint32_t node;
      Box3f cell;
      uint32_t depth;
    };
    std::vector<Place> stack{{0, tree_.bounds, 0}};
    while (!stack.empty()) {
      const Place place = stack.back();
      stack.pop_back();
      if (place.node != next_node || place.node >= tree_.nodes.size())
        return fail("a link leads to " + at("node", place.node));
      first_slot_[next_node++] = next_slot;
      const KdNode& node = tree_.nodes[place.node];
      if (place.depth > max_depth_)
        return fail(at("node", place.node) + " is deeper than " + std::to_string(max_depth_));
      if (node.is_leaf()) {
        if (node.first() != next_slot) return fail(at("node", place.node) + " has slots out of order");
        if (node.count() > tree_.slots.size() - next_slot)
          return fail(at("node", place.node) + " has slots out of range");
        next_slot += node.count();
        continue;
      }
      const float plane = node.plane();
      if (!(place.cell.lower[node.axis()] < plane && plane < place.cell.upper[node.axis()])) {
        return fail(at("node", place.node) + " has its plane outside its cell");
      }
      stack.push_back({node.above(), above_plane(place.cell, node.axis(), plane), place.depth + 1});
      stack.push_back({place.node + 1, below_plane(place.cell, node.axis(), plane), place.depth + 1});
    }
    if (next_node != tree_.nodes.size()) return fail("a node that nothing leads to");
    if (next_slot != tree_.slots.size()) return fail("a slot in no leaf");
    return true;
  }

  void place_slots() {
    places_.reserve(tree_.slots.size());
    for (uint32_t i = 0; i < tree_.slots.size(); ++i) places_.emplace_back(name_of(tree_.slots[i]), i);
    std::sort(places_.begin(), places_.end());
  }

  /// Whether the primitive stands in a slot of [begin, end).
  bool stands_in(uint64_t name, uint32_t begin, uint32_t end) const {
    const auto found = std::lower_bound(places_.begin(), places_.end(), std::pair(name, begin));
    return found != places_.end() && found->first == name && found->second < end;
  }

  /// Follows the items into the leaves below a node.
  void check_cell(uint32_t number, const Box3f& cell, std::vector<Item> items) {
    if (fault_) return;
    const KdNode& node = tree_.nodes[number];
    if (node.is_leaf()) {
      check_leaf(number, cell, items);
      return;
    }
    const uint32_t axis = node.axis();
    const float plane = node.plane();
    std::vector<Item> below, above;
    for (const Item& item : items) {
      const float lower = item.box.lower[axis], upper = item.box.upper[axis];
      if (lower < plane && plane < upper) {
        add_parts(item, axis, plane, below, above);
      } else if (lower == plane && upper == plane) {  // one side must have all of it
        const bool is_below = stands_in(item.name, first_slot_[number + 1], first_slot_[node.above()]);
        (is_below ? below : above).push_back(item);
      } else {
        (upper <= plane ? below : above).push_back(item);
      }
    }
    std::vector<Item>().swap(items);
    check_cell(number + 1, below_plane(cell, axis, plane), std::move(below));
    check_cell(node.above(), above_plane(cell, axis, plane), std::move(above));
  }

  /// What a builder does: cut the whole primitive to the box that is left of it.
  void add_parts(const Item& item, uint32_t axis, float plane, std::vector<Item>& below, std::vector<Item>& above) {
    const auto cut = [&](const Box3f& box) {
      return clipped_bounds(geometries_[item.geometry()], item.primitive(), box);
    };
    const Box3f box_below = below_plane(item.box, axis, plane), box_above = above_plane(item.box, axis, plane);
    Box3f part_below = cut(box_below), part_above = cut(box_above);
    if (part_below.is_empty() && part_above.is_empty()) {  // only rounding can do that
      part_below = box_below;
      part_above = box_above;
    }
    if (!part_below.is_empty()) below.push_back({item.name, part_below});
    if (!part_above.is_empty()) above.push_back({item.name, part_above});
  }

  void check_leaf(uint32_t number, const Box3f& cell, const std::vector<Item>& items) {
    const uint32_t begin = first_slot_[number], end = begin + tree_.nodes[number].count();
    for (const Item& item : items) {
      if (!stands_in(item.name, begin, end)) {
        fail(at("node", number) + " lacks primitive " + std::to_string(item.primitive()) + " of geometry " +
             std::to_string(item.geometry()));
        return;
      }
    }
    for (uint32_t slot = begin; slot < end; ++slot) {
      const LeafSlot& s = tree_.slots[slot];
      if (stands_in(name_of(s), slot + 1, end)) fail(at("slot", slot) + " stands in its leaf twice");
      const Box3f box = primitive_bounds(geometries_[s.geometry()], s.primitive);
      if (intersected(box, cell).is_empty()) fail(at("slot", slot) + " does not reach into its cell");
    }
    if (!boxes_only_ && items.size() != end - begin) {
      fail(at("node", number) + " has primitives that do not reach into its cell");
    }
  }

  const KdTree& tree_;
  std::span<const Geometry> geometries_;
  bool boxes_only_;
  uint32_t max_depth_;
  std::optional<std::string> fault_;
  std::vector<uint32_t> first_slot_;                   ///< of the leaves below each node
  std::vector<std::pair<uint64_t, uint32_t>> places_;  ///< primitive and slot, sorted
};

}  // namespace

void mark_repeated(KdTree& tree, std::span<const Geometry> geometries) {
  std::vector<size_t> first;
  size_t total = 0;
  for (const Geometry& geometry : geometries) {
    first.push_back(total);
    total += primitive_count(geometry);
  }
  std::vector<uint8_t> count(total);  // 2 stands for more
  const auto count_of = [&](const LeafSlot& slot) -> uint8_t& {
    return count[first[slot.geometry()] + slot.primitive];
  };
  for (LeafSlot& slot : tree.slots) {
    slot.geometry_bits = slot.geometry();
    uint8_t& seen = count_of(slot);
    if (seen < 2) ++seen;
  }
  for (LeafSlot& slot : tree.slots) {
    if (count_of(slot) > 1) slot.geometry_bits |= LeafSlot::kRepeated;
  }
}

uint64_t tree_hash(const KdTree& tree) {
  uint64_t state = 0;
  const auto add = [&](uint32_t high, uint32_t low) {
    state = mix(state + 0x9E3779B97F4A7C15U + (uint64_t{high} << 32 | low));
  };
  for (uint32_t axis = 0; axis < 3; ++axis) {
    add(std::bit_cast<uint32_t>(tree.bounds.lower[axis]), std::bit_cast<uint32_t>(tree.bounds.upper[axis]));
  }
  add(static_cast<uint32_t>(tree.nodes.size()), static_cast<uint32_t>(tree.slots.size()));
  for (const KdNode& node : tree.nodes) add(node.word, node.index_bits);
  for (const LeafSlot& slot : tree.slots) add(slot.geometry_bits, slot.primitive);
  return state;
}

std::optional<std::string> find_fault(const KdTree& tree, std::span<const Geometry> geometries, bool boxes_only,
                                      uint32_t max_depth) {
  return Checker(tree, geometries, boxes_only, max_depth).find();
}

}  // namespace kerf
