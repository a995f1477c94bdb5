#include "kerf/tree/bvh.h"

#include <algorithm>
#include <bit>

#include "kerf/base/mix.h"
#include "kerf/base/parallel.h"

namespace kerf {
namespace {

/// Calls f(node number, depth) for every node that can be reached, parents first, by following the children's numbers.
/// f returns false to stop.
template <class F>
void visit(const Bvh& bvh, F&& f) {
  if (bvh.nodes.empty()) return;
  std::vector<std::pair<uint32_t, uint32_t>> stack{{0, 0}};
  while (!stack.empty()) {
    const auto [number, depth] = stack.back();
    stack.pop_back();
    if (!f(number, depth)) return;
    const BvhNode& node = bvh.nodes[number];
    if (node.is_leaf()) continue;
    stack.emplace_back(node.first + 1, depth + 1);
    stack.emplace_back(node.first, depth + 1);
  }
}

/// How often each primitive stands in the slots, by geometry's first number + primitive; 2 stands for more.
struct SlotCounts {
  std::vector<size_t> first;
  std::vector<uint8_t> count;

  SlotCounts(const Bvh& bvh, std::span<const Geometry> geometries) {
    size_t total = 0;
    for (const Geometry& geometry : geometries) {
      first.push_back(total);
      total += primitive_count(geometry);
    }
    count.resize(total);
    for (const LeafSlot& slot : bvh.slots) {
      uint8_t& seen = of(slot);
      if (seen < 2) ++seen;
    }
  }
  uint8_t& of(const LeafSlot& slot) { return count[first[slot.geometry()] + slot.primitive]; }
};

class Hash {
 public:
  void add(uint64_t value) { state_ = mix(state_ + 0x9E3779B97F4A7C15U + value); }
  void add(Vec3f p) {
    add(uint64_t{std::bit_cast<uint32_t>(p.x)} << 32 | std::bit_cast<uint32_t>(p.y));
    add(std::bit_cast<uint32_t>(p.z));
  }
  uint64_t value() const { return state_; }

 private:
  uint64_t state_ = 0;
};

std::string at(const char* what, size_t number) { return std::string(what) + " " + std::to_string(number); }

std::optional<std::string> find_slot_fault(const Bvh& bvh, std::span<const Geometry> geometries) {
  for (size_t i = 0; i < bvh.slots.size(); ++i) {
    const LeafSlot& slot = bvh.slots[i];
    if (slot.geometry() >= geometries.size() || slot.primitive >= primitive_count(geometries[slot.geometry()])) {
      return at("slot", i) + " names no primitive";
    }
  }
  SlotCounts counts(bvh, geometries);
  for (size_t i = 0; i < bvh.slots.size(); ++i) {
    if ((counts.of(bvh.slots[i]) > 1) != bvh.slots[i].is_repeated())
      return at("slot", i) + " has the wrong repeat mark";
  }
  return std::nullopt;
}

/// What is wrong with one node, its children in range or its slots included; marks the slots it uses.
std::string find_node_fault(const Bvh& bvh, uint32_t number, uint32_t largest_leaf, std::vector<bool>& slot_used) {
  const BvhNode& node = bvh.nodes[number];
  if (node.bounds().is_empty()) return "has an empty box";
  if (node.is_leaf()) {
    if (node.count > largest_leaf) return "is too large a leaf";
    if (node.first > bvh.slots.size() || node.count > bvh.slots.size() - node.first) return "has slots out of range";
    for (uint32_t s = node.first; s < node.first + node.count; ++s) {
      if (slot_used[s]) return "uses a slot of another leaf";
      slot_used[s] = true;
    }
    return {};
  }
  if (node.first <= number || node.first + size_t{1} >= bvh.nodes.size()) return "has children out of range";
  if (node.first % 2 == 0) return "has children that are no pair";
  const Box3f children = united(bvh.nodes[node.first].bounds(), bvh.nodes[node.first + 1].bounds());
  if (children != node.bounds()) return "is not the union of its children";
  return {};
}

}  // namespace

double sah_cost(const Bvh& bvh, double inner_cost, double primitive_cost) {
  if (bvh.nodes.empty()) return 0;
  const double root = half_area(bvh.nodes[0].bounds());
  double sum = 0;
  for (const BvhNode& node : bvh.nodes) {
    sum += half_area(node.bounds()) * (node.is_leaf() ? primitive_cost * node.count : inner_cost);
  }
  return root > 0 ? sum / root : 0;
}

BvhStatistics measure(const Bvh& bvh) {
  BvhStatistics result;
  result.nodes = bvh.nodes.size();
  visit(bvh, [&](uint32_t number, uint32_t depth) {
    const BvhNode& node = bvh.nodes[number];
    result.depth = std::max(result.depth, depth);
    result.largest_leaf = std::max(result.largest_leaf, node.count);
    result.leaves += node.is_leaf() ? 1 : 0;
    return true;
  });
  result.sah_cost = sah_cost(bvh);
  return result;
}

uint64_t tree_hash(const Bvh& bvh) {
  // Blocks of fixed size, so that they can be hashed in parallel, and their hashes in order.
  constexpr size_t kGrain = size_t{1} << 16;
  const auto hash_blocks = [](size_t count, auto&& add_one) {
    std::vector<uint64_t> blocks((count + kGrain - 1) / kGrain);
    parallel_for(count, kGrain, [&](size_t begin, size_t end) {
      Hash hash;
      for (size_t i = begin; i < end; ++i) add_one(hash, i);
      blocks[begin / kGrain] = hash.value();
    });
    Hash all;
    all.add(count);
    for (const uint64_t block : blocks) all.add(block);
    return all.value();
  };
  Hash hash;
  hash.add(hash_blocks(bvh.nodes.size(), [&](Hash& h, size_t i) {
    h.add(bvh.nodes[i].lower);
    h.add(bvh.nodes[i].upper);
    h.add(uint64_t{bvh.nodes[i].first} << 32 | bvh.nodes[i].count);
  }));
  hash.add(hash_blocks(bvh.slots.size(), [&](Hash& h, size_t i) {
    h.add(uint64_t{bvh.slots[i].geometry_bits} << 32 | bvh.slots[i].primitive);
  }));
  return hash.value();
}

void mark_repeated(Bvh& bvh, std::span<const Geometry> geometries) {
  for (LeafSlot& slot : bvh.slots) slot.geometry_bits = slot.geometry();
  SlotCounts counts(bvh, geometries);
  for (LeafSlot& slot : bvh.slots) {
    if (counts.of(slot) > 1) slot.geometry_bits |= LeafSlot::kRepeated;
  }
}

std::optional<std::string> find_fault(const Bvh& bvh, std::span<const Geometry> geometries, uint32_t largest_leaf,
                                      uint32_t max_depth) {
  if (bvh.nodes.empty()) return bvh.slots.empty() ? std::nullopt : std::optional<std::string>("slots without nodes");
  if (auto fault = find_slot_fault(bvh, geometries)) return fault;
  std::vector<bool> node_seen(bvh.nodes.size()), slot_used(bvh.slots.size());
  std::optional<std::string> fault;
  visit(bvh, [&](uint32_t number, uint32_t depth) {
    std::string what = node_seen[number]   ? "is reached twice"
                       : depth > max_depth ? "is deeper than " + std::to_string(max_depth)
                                           : find_node_fault(bvh, number, largest_leaf, slot_used);
    node_seen[number] = true;
    if (!what.empty()) fault = at("node", number) + " " + what;
    return what.empty();
  });
  if (fault) return fault;
  if (std::find(node_seen.begin(), node_seen.end(), false) != node_seen.end()) return "a node that nothing leads to";
  if (std::find(slot_used.begin(), slot_used.end(), false) != slot_used.end()) return "a slot in no leaf";
  return std::nullopt;
}

}  // namespace kerf
