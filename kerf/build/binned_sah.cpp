#include "kerf/build/binned_partition.h"
#include "kerf/build/builders.h"

namespace kerf {

Bvh build_binned_sah(BuildInput input, const OptionValues& options) {
  if (options.is_set("bins") && options.is_set("planes")) {
    throw Error(ErrorCode::invalid_option, "binned_sah",
                "bins and planes say the same thing (bins = planes + 1): give one");
  }
  const double bins = options.is_set("planes") ? options["planes"] + 1 : options["bins"];
  BinnedSah partition(std::move(input.references), static_cast<uint32_t>(bins));
  return build_top_down(partition, TopDownOptions::from(options), input.limit);
}

}  // namespace kerf
