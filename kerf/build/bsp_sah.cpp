#include "kerf/build/bsp_sah.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "kerf/base/parallel.h"
#include "kerf/build/bsp_choice.h"
#include "kerf/geometry/clip.h"

namespace kerf {
namespace {

constexpr uint32_t kParallelCount = 2048;  // fewer pieces are not worth a task

/// A cell while the tree grows.
struct Grown {
  BspNode node;  ///< without numbers of children and slots
  BspCell cell;
  std::vector<LeafSlot> slots;
  std::unique_ptr<Grown> child[2];
};

/// How much has grown.
struct Size {
  size_t nodes = 0, leaves = 0, slots = 0;

  explicit Size(const Grown& grown) { add(grown); }
  void add(const Grown& grown) {
    ++nodes;
    leaves += grown.child[0] == nullptr ? 1 : 0;
    slots += grown.slots.size();
    for (const auto& child : grown.child) {
      if (child != nullptr) add(*child);
    }
  }
  size_t bytes() const {
    constexpr size_t kOverhead = 16;  // of an allocation
    return nodes * (sizeof(Grown) + kOverhead) + leaves * kOverhead + slots * sizeof(LeafSlot);
  }
};

/// The recursion.
class Grower {
 public:
  Grower(const BspOptions& options, const WorkLimit& limit, double slack)
      : options_(options), limit_(limit), slack_(slack) {}

  /// `share`: how many references the leaves below may have together.
  std::unique_ptr<Grown> grow(BspPieces pieces, const ConvexCell& cell, const Box3f& around, uint64_t share,
                              uint32_t depth) const {
    const bool is_large = pieces.size() >= kParallelCount;
    HeldBytes held(is_large ? pieces.bytes() : 0);
    auto grown = std::make_unique<Grown>();
    grown->cell = {box_of(pieces, cell, around), cell.area()};
    const auto plane =
        depth < options_.max_depth ? cheapest_plane(cell, grown->cell.bounds, pieces, share, options_) : std::nullopt;
    auto parts = plane ? std::optional(pieces.cut(*plane)) : std::nullopt;
    // Counting may differ from cutting by a rounding: the cap is kept all the same.
    if (!parts || uint64_t{parts->first.size()} + parts->second.size() > share) {
      grown->slots.reserve(pieces.size());
      for (const BspPiece& piece : pieces.list()) {
        const Reference& reference = pieces.reference_of(piece);
        grown->slots.push_back({reference.geometry, reference.primitive});
      }
      if (is_large) limit_.advance(work_of_dividing(static_cast<double>(share)));
      return grown;
    }
    grown->node = {plane->normal, 0, plane->offset, 0, plane->kind()};
    const uint32_t count = pieces.size();
    pieces = BspPieces(std::move(parts->first));
    held.release();
    divide(*grown, {std::move(pieces), std::move(parts->second)}, cell.cut(*plane), share, depth, count);
    return grown;
  }

 private:
  void divide(Grown& grown, std::pair<BspPieces, BspPieces> pieces, const ConvexCell::Parts& cells, uint64_t share,
              uint32_t depth, uint32_t count) const {
    const uint64_t below = pieces.first.size(), above = pieces.second.size();
    const uint64_t rest = share - below - above;
    const double cost_below = static_cast<double>(below) * cells.below.area();
    const double cost = cost_below + static_cast<double>(above) * cells.above.area();
    const double part = cost > 0 ? cost_below / cost : 0.5;
    const uint64_t for_below = below + static_cast<uint64_t>(static_cast<double>(rest) * part);
    const Box3f around = grown.cell.bounds;
    const auto grow_child = [&](int i, BspPieces& some, const ConvexCell& part_cell, uint64_t allowed) {
      const bool is_told = count >= kParallelCount && some.size() < kParallelCount;
      grown.child[i] = grow(std::move(some), part_cell, around, allowed, depth + 1);
      if (!is_told) return;
      held_.add(Size(*grown.child[i]).bytes());
      limit_.advance(work_of_dividing(static_cast<double>(allowed)));
    };
    const auto grow_below = [&] { grow_child(0, pieces.first, cells.below, for_below); };
    const auto grow_above = [&] { grow_child(1, pieces.second, cells.above, share - for_below); };
    if (count >= kParallelCount) {
      limit_.advance(work_of_dividing(static_cast<double>(share)) - work_of_dividing(static_cast<double>(for_below)) -
                     work_of_dividing(static_cast<double>(share - for_below)));
      parallel_invoke(grow_below, grow_above);
    } else {
      grow_below();
      grow_above();
    }
  }

  /// Around the cell, as far as parts of primitives may reach, and the pieces in it, within the parent's box.
  Box3f box_of(const BspPieces& pieces, const ConvexCell& cell, const Box3f& around) const {
    const auto [lower, upper] = cell.bounds();
    Box3f box = pieces.bounds();
    const Vec3d reach{slack_, slack_, slack_};
    if (lower.x <= upper.x) box.extend(outward(lower - reach, upper + reach));
    box = intersected(box, around);
    return box.is_empty() ? Box3f{} : box;
  }

  const BspOptions& options_;
  const WorkLimit& limit_;
  double slack_;
  mutable HeldBytes held_;  // what has grown
};

/// Numbers nodes in depth-first order of pairs.
void flatten(const Grown& root, BspTree& tree) {
  std::vector<std::pair<const Grown*, uint32_t>> stack{{&root, 0}};
  const Size size(root);
  const HeldBytes held(size.nodes * (sizeof(BspNode) + sizeof(BspCell)) + size.slots * sizeof(LeafSlot));
  tree.nodes.reserve(size.nodes);
  tree.cells.reserve(size.nodes);
  tree.slots.reserve(size.slots);
  tree.nodes.push_back(root.node);
  tree.cells.push_back(root.cell);
  while (!stack.empty()) {
    const auto [grown, number] = stack.back();
    stack.pop_back();
    if (grown->child[0] == nullptr) {
      tree.nodes[number].first = static_cast<uint32_t>(tree.slots.size());
      tree.nodes[number].count = static_cast<uint32_t>(grown->slots.size());
      tree.slots.insert(tree.slots.end(), grown->slots.begin(), grown->slots.end());
      continue;
    }
    const auto first = static_cast<uint32_t>(tree.nodes.size());
    tree.nodes[number].first = first;
    for (const auto& child : grown->child) {
      tree.nodes.push_back(child->node);
      tree.cells.push_back(child->cell);
    }
    stack.emplace_back(grown->child[1].get(), first + 1);
    stack.emplace_back(grown->child[0].get(), first);
  }
}

}  // namespace

BspOptions BspOptions::from(const OptionValues& values) {
  return {static_cast<uint32_t>(values["depth"]),
          static_cast<uint32_t>(values["faces"]),
          static_cast<uint32_t>(values["slices"]),
          values["cap"],
          values["axis_cost"],
          values["oblique_cost"],
          values["primitive_cost"]};
}

BspTree build_bsp_sah(std::span<const Geometry> geometries, const std::vector<Reference>& references,
                      const BspOptions& options, const WorkLimit& limit) {
  BspTree tree;
  if (references.empty()) return tree;
  for (const Reference& reference : references) tree.bounds.extend(reference.bounds());
  const Vec3d lower = to_double(tree.bounds.lower), upper = to_double(tree.bounds.upper);
  const double extent = largest(upper - lower), farthest = largest(max(abs(lower), abs(upper)));
  // A face's plane, its normal rounded to float, is off by 2^-24 of the face; what lies within twice that of a plane
  // counts as in it. kMaxDepth cuts, each off by some 2^-51 of a coordinate, come on top.
  const double tolerance = 0x1p-23 * extent + 0x1p-44 * farthest;
  tree.slack = 2 * tolerance;
  limit.check(references.size() * (sizeof(BspPiece) + 3 * sizeof(Vec3d) + sizeof(Grown)));
  BspPieces pieces(geometries, references, tolerance);
  for (uint32_t i = 0; i < references.size(); ++i) pieces.add_whole(i);
  const double cap = std::min(options.cap * static_cast<double>(references.size()), double{kMaxReferences});
  const uint64_t share = std::max<uint64_t>(static_cast<uint64_t>(cap), references.size());
  limit.plan(work_of_dividing(static_cast<double>(share)));
  const Grower grower(options, limit, tree.slack);  // it accounts for what grows
  const std::unique_ptr<Grown> root = grower.grow(std::move(pieces), ConvexCell(tree.bounds), tree.bounds, share, 0);
  flatten(*root, tree);
  return tree;
}

}  // namespace kerf
