#include "kerf/build/binned_partition.h"
#include "kerf/build/builders.h"
#include "kerf/build/spatial_order.h"
#include "kerf/references/split_each.h"

namespace kerf {
namespace {

/// Of this builder, besides what all top-down builders share.
struct SpatialSplitOptions {
  uint32_t bins, spatial_bins;
  double overlap, node_overlap, favour;
};

/// The best division of whole references, as BinnedSah finds it.
class WholeDivision {
 public:
  WholeDivision(std::span<const Reference> references, const Subset& subset, uint32_t bin_count)
      : slices_(subset.centers, detail::bins_for(subset.count(), bin_count)) {
    Box4 left = Box4::empty(), right = left;
    if (subset.count() <= std::min(bin_count, FewReferences::kMost)) {
      few_.emplace(references);
      cost_ = few_->cost();
      if (is_found()) left = Box4::of(few_->left_bounds());
      if (is_found()) right = Box4::of(few_->right_bounds());
    } else {
      detail::Bins bins;
      detail::fill_parallel(references, slices_, bins);
      plane_ = detail::cheapest_plane(bins, slices_);
      cost_ = plane_.cost;
      for (uint32_t i = 0; is_found() && i < slices_.bins; ++i) {
        (i < plane_.bin ? left : right).extend(bins[plane_.axis][i].box);
      }
    }
    overlap_ = half_area(is_found() ? intersected(left.box(), right.box()) : subset.bounds);
    if (is_found()) areas_ = left.half_area() + right.half_area();
  }

  bool is_found() const { return !std::isinf(cost_); }
  double cost() const { return cost_; }
  /// Half the area of what the boxes on both sides have in common; without a division, of the whole.
  double overlap() const { return overlap_; }
  /// Of a division.
  detail::AreaSums sums() const { return {areas_, cost_}; }

  Halves apply(SpatialOrder& order, const Subset& subset) const {
    if (!is_found()) return order.halve(subset);
    if (few_) return order.arrange(subset, *few_);
    return order.partition(subset, detail::BelowPlane(slices_, plane_));
  }

 private:
  detail::Slices slices_;
  detail::Plane plane_;
  std::optional<FewReferences> few_;
  double cost_ = 0, overlap_ = 0, areas_ = 0;
};

/// At each node the cheaper of the best division of whole references and the best plane to cut at (Stich, Friedrich,
/// Dietrich: Spatial Splits in Bounding Volume Hierarchies, 2009). Not of the paper: the room that each node has for
/// pieces, and that cuts are favoured.
class SpatialSplit {
 public:
  SpatialSplit(SpatialOrder& order, const Clipper& clipper, const SpatialSplitOptions& own,
               const TopDownOptions& shared, BuildNotes* notes)
      : order_(order),
        clipper_(clipper),
        own_(own),
        shared_(shared),
        notes_(notes),
        least_overlap_(own.overlap * half_area(order.whole().bounds)) {}

  std::optional<Halves> divide(const Subset& subset, uint32_t depth) {
    if (subset.count() == 1 || depth == shared_.max_depth) return std::nullopt;
    if (subset.count() <= shared_.leaf_size && detail::leaf_is_cheapest(subset, shared_)) return std::nullopt;
    const uint64_t most = detail::capacity(shared_.leaf_size, shared_.max_depth - depth - 1);
    const WholeDivision whole(order_.references(subset), subset, own_.bins);
    const bool may_cut = whole.overlap() > std::max(least_overlap_, own_.node_overlap * half_area(subset.bounds));
    const SpatialPlane spatial = may_cut ? find_spatial(subset, subset.spare, whole.cost(), most) : SpatialPlane{};
    const bool is_asked = subset.lost > 0 && !notes_->short_of_room.load(std::memory_order_relaxed);
    if (may_cut && is_asked) look_for_lost(subset, whole.cost(), most);
    if (subset.count() <= shared_.leaf_size) {
      if (!spatial.is_found() && !whole.is_found()) return std::nullopt;
      const detail::AreaSums sums = spatial.is_found() ? sums_of(spatial) : whole.sums();
      if (detail::leaf_is_cheaper(subset, sums, shared_)) return std::nullopt;
    }
    Halves halves = spatial.is_found() ? order_.cut(subset, spatial, clipper_) : divide_whole(subset, whole, most);
    Subset given = subset;
    if (!is_asked) given.lost = 0;
    order_.make_room(given, halves);
    return halves;
  }

 private:
  /// A plane to cut at, not much dearer than the best object split, and cheaper than a leaf. Areas times counts take a
  /// half for a leaf: they overrate what more references cost in a tree, and do not see what overlap costs further
  /// down. With so many free places.
  SpatialPlane find_spatial(const Subset& subset, uint32_t spare, double object_cost, uint64_t most) const {
    if (spare == 0) return {};
    double cost = own_.favour * object_cost;
    if (subset.count() <= shared_.leaf_size) {
      const double leaf = subset.count() + (shared_.leaf_cost - shared_.inner_cost) / shared_.primitive_cost;
      cost = std::min(cost, leaf * half_area(subset.bounds));
    }
    const SpatialSlices slices(subset.bounds, own_.spatial_bins);
    return cheapest_spatial_plane(order_.references(subset), {}, slices, clipper_,
                                  {static_cast<double>(subset.count() + spare), static_cast<double>(most), cost});
  }

  /// Notes whether the best cut is one that only the lost places had room for. As long as none is, all is as if none
  /// were lost, so the first one on each way down is found, and the outcome does not depend on who looks first.
  void look_for_lost(const Subset& subset, double object_cost, uint64_t most) {
    if (subset.spare >= subset.count()) return;  // no plane needs more
    const SpatialPlane wanted = find_spatial(subset, subset.spare + subset.lost, object_cost, most);
    if (!wanted.is_found() || wanted.both() <= subset.room()) return;
    if (subset.count() <= shared_.leaf_size && detail::leaf_is_cheaper(subset, sums_of(wanted), shared_)) return;
    notes_->short_of_room = true;
  }

  static detail::AreaSums sums_of(const SpatialPlane& plane) {
    return {half_area(plane.below) + half_area(plane.above), plane.cost};
  }

  Halves divide_whole(const Subset& subset, const WholeDivision& whole, uint64_t most) {
    // Where no plane divides, or a lopsided one would break the depth bound further down: equal counts keep it.
    const Halves halves = whole.apply(order_, subset);
    return std::max(halves.left.count(), halves.right.count()) <= most ? halves : order_.halve(subset);
  }

  SpatialOrder& order_;
  const Clipper& clipper_;
  SpatialSplitOptions own_;
  const TopDownOptions& shared_;
  BuildNotes* notes_;  // only looked at where places were lost
  double least_overlap_;
};

/// The slots of references in an order with free places.
std::vector<LeafSlot> slots_of(const SpatialOrder& order) {
  std::vector<LeafSlot> slots(order.whole().room());
  parallel_for(slots.size(), 65536, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Reference& reference = order.reference(static_cast<uint32_t>(i));
      slots[i] = {reference.geometry, reference.primitive};
    }
  });
  return slots;
}

/// The leaves' slots side by side. A primitive whose pieces ended in one leaf gets one slot there.
void gather_slots(Bvh& bvh, const std::vector<LeafSlot>& spread) {
  size_t count = 0;
  for (const BvhNode& node : bvh.nodes) count += node.count;
  bvh.slots.reserve(count);
  std::vector<LeafSlot> leaf;
  LimitWatch watch;
  for (BvhNode& node : bvh.nodes) {
    if (!node.is_leaf()) continue;
    watch.step();
    leaf.assign(spread.begin() + node.first, spread.begin() + node.first + node.count);
    std::sort(leaf.begin(), leaf.end(), [](const LeafSlot& a, const LeafSlot& b) {
      return std::make_pair(a.geometry_bits, a.primitive) < std::make_pair(b.geometry_bits, b.primitive);
    });
    leaf.erase(std::unique(leaf.begin(), leaf.end()), leaf.end());
    node.first = static_cast<uint32_t>(bvh.slots.size());
    node.count = static_cast<uint32_t>(leaf.size());
    bvh.slots.insert(bvh.slots.end(), leaf.begin(), leaf.end());
  }
  bvh.slots.shrink_to_fit();
}

/// Cutting may leave less of a reference's box than there was.
void shrink_to_children(std::vector<BvhNode>& nodes) {
  for (size_t i = nodes.size(); i-- > 0;) {
    if (nodes[i].is_leaf()) continue;
    const Box3f box = united(nodes[nodes[i].first].bounds(), nodes[nodes[i].first + 1].bounds());
    nodes[i].lower = box.lower;
    nodes[i].upper = box.upper;
  }
}

}  // namespace

Bvh build_spatial_split(BuildInput input, const OptionValues& options) {
  const TopDownOptions shared = TopDownOptions::from(options);
  const auto bins = static_cast<uint32_t>(options["bins"]);
  if (input.clipper.function == nullptr) {
    BinnedSah partition(std::move(input.references), bins);
    return build_top_down(partition, shared, input.limit);
  }
  if (input.references.empty()) return {};
  // Where memory allows fewer pieces, fewer are made.
  const size_t count = input.references.size();
  const size_t wanted = std::max(count, most_references(count, options["cap"]));
  const size_t room = std::max(count, std::min({wanted, input.most, input.limit.bytes / kSpatialSplitBytes}));
  SpatialOrder order(std::move(input.references), room);
  SpatialSplit divider(order, input.clipper,
                       {bins, static_cast<uint32_t>(options["spatial_bins"]), options["overlap"],
                        options["node_overlap"], options["favour"]},
                       shared, input.notes);
  Subset whole = order.whole();
  if (input.notes != nullptr) whole.lost = static_cast<uint32_t>(wanted - room);
  TreePart tree = detail::build_parts(divider, whole, shared, input.limit);
  HeldBytes slots(room * sizeof(LeafSlot));
  const std::vector<LeafSlot> spread = slots_of(order);
  order.free_references();
  slots.set(2 * room * sizeof(LeafSlot));  // spread and gathered
  Bvh bvh;
  bvh.nodes = joined(std::move(tree));
  shrink_to_children(bvh.nodes);
  gather_slots(bvh, spread);
  return bvh;
}

}  // namespace kerf
