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

Bvh build_object_median(std::vector<Reference> references, const OptionValues& options, const WorkLimit& limit) {
  ObjectMedian partition(std::move(references));
  return build_top_down(partition, TopDownOptions::from(options), limit);
}

}  // namespace kerf
