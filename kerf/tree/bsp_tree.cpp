#include "kerf/tree/bsp_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kerf/tree/hash_values.h"

namespace kerf {
namespace {

bool operator==(const LeafSlot& slot, std::pair<uint32_t, uint32_t> primitive) {
  return slot.geometry_bits == primitive.first && slot.primitive == primitive.second;
}

std::string at(const char* what, size_t number) { return std::string(what) + " " + std::to_string(number) + " "; }

/// Walks the tree and keeps the first thing that is wrong.
class Checker {
 public:
  Checker(const BspTree& tree, std::span<const Geometry> geometries)
      : tree_(tree), geometries_(geometries), node_seen_(tree.nodes.size()), slot_used_(tree.slots.size()) {}

  std::optional<std::string> find() {
    if (tree_.cells.size() != tree_.nodes.size()) return "not one cell for each node";
    if (!(tree_.slack >= 0) || !std::isfinite(tree_.slack)) return "the slack is no distance";
    for (size_t i = 0; i < tree_.slots.size(); ++i) {
      const LeafSlot& slot = tree_.slots[i];
      if (slot.is_repeated()) return at("slot", i) + "has a mark";
      if (slot.geometry() >= geometries_.size() || slot.primitive >= primitive_count(geometries_[slot.geometry()])) {
        return at("slot", i) + "names no primitive";
      }
    }
    if (!tree_.nodes.empty()) check(0, 0);
    if (fault_) return fault_;
    if (std::find(node_seen_.begin(), node_seen_.end(), false) != node_seen_.end()) {
      return "a node that nothing leads to";
    }
    if (std::find(slot_used_.begin(), slot_used_.end(), false) != slot_used_.end()) return "a slot in no leaf";
    return fault_;
  }

 private:
  void check(uint32_t number, uint32_t depth) {
    if (fault_) return;
    const BspNode& node = tree_.nodes[number];
    node_seen_[number] = true;
    if (depth > kMaxDepth) return fail(number, "is deeper than " + std::to_string(kMaxDepth));
    if (node.kind > BspNode::kLeaf) return fail(number, "is of no kind");
    if (node.is_leaf()) return check_leaf(number);
    if (!has_plane(node)) return fail(number, "has no proper plane");
    if (node.count != 0) return fail(number, "has slots, but is no leaf");
    if (node.first <= number || size_t{node.first} + 1 >= tree_.nodes.size() || node.first % 2 == 0) {
      return fail(number, "has children out of range");
    }
    for (const uint32_t child : {node.first, node.first + 1}) {
      if (node_seen_[child]) return fail(child, "is reached twice");
      if (!tree_.cells[number].bounds.contains(tree_.cells[child].bounds)) {
        return fail(child, "reaches out of its parent's box");
      }
      check(child, depth + 1);
    }
  }

  static bool has_plane(const BspNode& node) {
    constexpr double kPrecision = 0x1p-20;
    const Vec3d normal = to_double(node.normal);
    if (!std::isfinite(node.offset)) return false;
    return node.kind == node.plane().kind() && std::abs(dot(normal, normal) - 1) <= kPrecision;
  }

  void check_leaf(uint32_t number) {
    const BspNode& node = tree_.nodes[number];
    if (node.first > tree_.slots.size() || node.count > tree_.slots.size() - node.first) {
      return fail(number, "has slots out of range");
    }
    std::vector<std::pair<uint32_t, uint32_t>> primitives;
    for (uint32_t s = node.first; s < node.first + node.count; ++s) {
      if (slot_used_[s]) return fail(number, "uses a slot of another leaf");
      slot_used_[s] = true;
      primitives.emplace_back(tree_.slots[s].geometry_bits, tree_.slots[s].primitive);
    }
    std::sort(primitives.begin(), primitives.end());
    if (std::adjacent_find(primitives.begin(), primitives.end()) != primitives.end()) {
      fail(number, "has a primitive twice");
    }
  }

  void fail(uint32_t number, const std::string& what) {
    if (!fault_) fault_ = at("node", number) + what;
  }

  const BspTree& tree_;
  std::span<const Geometry> geometries_;
  std::vector<bool> node_seen_, slot_used_;
  std::optional<std::string> fault_;
};

/// Corners and the middle of a primitive; of a sphere its poles.
std::vector<Vec3d> points_of(const Geometry& geometry, uint32_t primitive) {
  if (const auto* mesh = std::get_if<TriangleMesh>(&geometry.shapes)) {
    const Triangle t = mesh->triangle(primitive);
    const Vec3d a = to_double(t.a), b = to_double(t.b), c = to_double(t.c);
    return {a, b, c, (a + b + c) / 3};
  }
  if (const auto* shapes = std::get_if<Strided<Parallelogram>>(&geometry.shapes)) {
    const std::array<Vec3d, 4> c = (*shapes)[primitive].corners();
    return {c[0], c[1], c[2], c[3], (c[0] + c[2]) / 2};
  }
  const Sphere sphere = std::get<Strided<Sphere>>(geometry.shapes)[primitive];
  std::vector<Vec3d> poles(6, to_double(cleaned(sphere.center)));
  for (uint32_t i = 0; i < 6; ++i) poles[i][i / 2] += i % 2 == 0 ? sphere.radius : -sphere.radius;
  return poles;
}

/// Whether some leaf whose planes allow the point has the primitive.
bool is_found(const BspTree& tree, Vec3d point, std::pair<uint32_t, uint32_t> primitive, uint32_t number = 0) {
  const BspNode& node = tree.nodes[number];
  if (node.is_leaf()) {
    const auto begin = tree.slots.begin() + node.first, end = begin + node.count;
    return std::any_of(begin, end, [&](const LeafSlot& slot) { return slot == primitive; });
  }
  const double side = node.plane().side(point);
  return (side <= tree.slack && is_found(tree, point, primitive, node.first)) ||
         (side >= -tree.slack && is_found(tree, point, primitive, node.first + 1));
}

}  // namespace

uint64_t tree_hash(const BspTree& tree) {
  uint64_t hash = hash_values<BspNode>(0, tree.nodes);
  hash = hash_values<BspCell>(hash, tree.cells);
  hash = hash_values<LeafSlot>(hash, tree.slots);
  return hash_values<double>(hash, {&tree.slack, 1});
}

double sah_cost(const BspTree& tree) {
  if (tree.nodes.empty() || !(tree.cells[0].area > 0)) return 0;
  double sum = 0;
  for (size_t i = 0; i < tree.nodes.size(); ++i) {
    sum += tree.cells[i].area * (tree.nodes[i].is_leaf() ? tree.nodes[i].count : 1);
  }
  return sum / tree.cells[0].area;
}

std::optional<std::string> find_fault(const BspTree& tree, std::span<const Geometry> geometries) {
  if (auto fault = Checker(tree, geometries).find()) return fault;
  for (uint32_t g = 0; g < geometries.size(); ++g) {
    for (uint32_t p = 0; p < primitive_count(geometries[g]); ++p) {
      if (find_defect(geometries[g], p) != Defect::none || is_degenerate(geometries[g], p)) continue;
      for (const Vec3d point : points_of(geometries[g], p)) {
        if (tree.nodes.empty() || !is_found(tree, point, {g, p})) {
          return "geometry " + std::to_string(g) + ", primitive " + std::to_string(p) + " is not where it should be";
        }
      }
    }
  }
  return std::nullopt;
}

}  // namespace kerf
