#include "kerf/build/builders.h"
#include "kerf/build/reference_order.h"

namespace kerf {
namespace {

class ObjectMedian : public ReferenceOrder {
 public:
  using ReferenceOrder::ReferenceOrder;

  std::optional<Halves> split(const Subset& subset) { return halve(subset); }
};

}  // namespace

Bvh build_object_median(BuildInput input, const OptionValues& options) {
  ObjectMedian partition(std::move(input.references));
  return build_top_down(partition, TopDownOptions::from(options), input.limit);
}

}  // namespace kerf
