#include "kerf/build/binned_partition.h"
#include "kerf/build/builders.h"

namespace kerf {
namespace {

/// Takes references that are nearly as large as their node off to a shelf, a child with nothing but such references,
/// so that they do not widen the boxes further down; the rest is cut by the surface area heuristic (Havran, Herzog,
/// Seidel 2006).
class Shelves : public BinnedSah {
 public:
  Shelves(std::vector<Reference> references, uint32_t bins, double share, uint32_t leaf_size)
      : BinnedSah(std::move(references), bins), share_(share), leaf_size_(leaf_size), on_shelf_(whole().count()) {}

  std::optional<Halves> split(const Subset& subset) {
    if (on_shelf_[subset.begin] != 0 && subset.count() <= leaf_size_) return std::nullopt;  // one leaf, no further
    const double limit = share_ * half_area(subset.bounds);
    const auto is_oversize = [limit](const Reference& r) { return half_area(r.bounds()) > limit; };
    const std::span<const Reference> all = references(subset);
    const auto oversize = static_cast<size_t>(std::count_if(all.begin(), all.end(), is_oversize));
    if (on_shelf_[subset.begin] != 0 || oversize == 0 || oversize == all.size()) return BinnedSah::split(subset);
    const Halves halves = partition(subset, is_oversize);
    std::fill(on_shelf_.begin() + halves.left.begin, on_shelf_.begin() + halves.left.end, uint8_t{1});
    return halves;
  }

 private:
  double share_;
  uint32_t leaf_size_;
  std::vector<uint8_t> on_shelf_;  ///< by place in the order; a subset writes to its own stretch only
};

}  // namespace

Bvh build_oversize_shelves(BuildInput input, const OptionValues& options) {
  const TopDownOptions shared = TopDownOptions::from(options);
  Shelves partition(std::move(input.references), static_cast<uint32_t>(options["bins"]), options["share"],
                    shared.leaf_size);
  return build_top_down(partition, shared, input.limit);
}

}  // namespace kerf
