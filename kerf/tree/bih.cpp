#include "kerf/tree/bih.h"

#include <algorithm>

#include "kerf/tree/cell_slots.h"

namespace kerf {
namespace {

/// The walk over nodes and slots that says what is wrong with them.
class Check {
 public:
  Check(const Bih& bih, std::span<const Geometry> geometries)
      : bih_(bih), geometries_(geometries), node_seen_(bih.nodes.size()), slot_used_(bih.slots.size()) {
    size_t total = 0;
    for (const Geometry& geometry : geometries) {
      first_.push_back(total);
      total += primitive_count(geometry);
    }
    covered_.resize(total);
  }

  std::optional<std::string> run() {
    if (std::string fault = visit(0, bih_.bounds, 0); !fault.empty()) return fault;
    if (std::find(node_seen_.begin(), node_seen_.end(), false) != node_seen_.end()) return "a node nothing leads to";
    if (std::find(slot_used_.begin(), slot_used_.end(), false) != slot_used_.end()) return "a slot in no leaf";
    for (const LeafSlot& slot : bih_.slots) {
      const Box3f whole = primitive_bounds(geometries_[slot.geometry()], slot.primitive);
      if (!covered_[first_[slot.geometry()] + slot.primitive].contains(whole)) {
        return "geometry " + std::to_string(slot.geometry()) + ", primitive " + std::to_string(slot.primitive) +
               " reaches out of its leaves";
      }
    }
    return std::nullopt;
  }

 private:
  std::string visit(uint32_t number, const Box3f& box, uint32_t depth) {
    const BihNode& node = bih_.nodes[number];
    const std::string name = "node " + std::to_string(number);
    if (node_seen_[number]) return name + " is reached twice";
    if (depth > kMaxDepth) return name + " is deeper than " + std::to_string(kMaxDepth);
    node_seen_[number] = true;
    if (node.is_leaf()) {
      const std::string fault = visit_leaf(node, box);
      return fault.empty() ? fault : name + fault;
    }
    if (node.child() <= number || node.child() + size_t{node.children()} > bih_.nodes.size()) {
      return name + " has children elsewhere";
    }
    for (uint32_t side = 0; side < 2; ++side) {
      const float clip = node.clip(side);
      if (!(box.lower[node.axis()] <= clip && clip <= box.upper[node.axis()])) return name + " has a plane outside it";
    }
    for (uint32_t side = 0; side < node.children(); ++side) {
      std::string fault = visit(node.child() + side, clipped_by(node, box, side), depth + 1);
      if (!fault.empty()) return fault;
    }
    return {};
  }

  std::string visit_leaf(const BihNode& node, const Box3f& box) {
    if (node.count() == 0) return " is empty";
    if (node.first() + size_t{node.count()} > bih_.slots.size()) return " has slots out of range";
    for (uint32_t s = node.first(); s < node.first() + node.count(); ++s) {
      if (slot_used_[s]) return " uses a slot of another leaf";
      slot_used_[s] = true;
      const LeafSlot& slot = bih_.slots[s];
      const Geometry& geometry = geometries_[slot.geometry()];
      const Box3f whole = primitive_bounds(geometry, slot.primitive);
      if (!slot.is_repeated() && !box.contains(whole)) return " does not hold its primitive";
      const Box3f part = box.contains(whole) ? whole : clipped_bounds(geometry, slot.primitive, box);
      if (part.is_empty()) return " holds a primitive that is elsewhere";
      covered_[first_[slot.geometry()] + slot.primitive].extend(part);
    }
    return {};
  }

  const Bih& bih_;
  std::span<const Geometry> geometries_;
  std::vector<bool> node_seen_, slot_used_;
  std::vector<size_t> first_;   // the place of each geometry's first primitive in covered_
  std::vector<Box3f> covered_;  // of each primitive: around its parts in leaves
};

}  // namespace

uint64_t tree_hash(const Bih& bih) {
  const std::span<const Box3f> bounds(&bih.bounds, 1);
  return data_hash(std::span(bih.nodes), data_hash(std::span(bih.slots), data_hash(bounds)));
}

std::optional<std::string> find_fault(const Bih& bih, std::span<const Geometry> geometries) {
  if (auto fault = find_slot_fault(bih.slots, geometries)) return fault;
  if (bih.is_empty()) return bih.slots.empty() ? std::nullopt : std::optional<std::string>("slots without nodes");
  return Check(bih, geometries).run();
}

}  // namespace kerf
