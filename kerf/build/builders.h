#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "kerf/base/options.h"
#include "kerf/base/work_limit.h"
#include "kerf/references/reference.h"
#include "kerf/tree/bvh.h"

namespace kerf {

/// One builder of the menu: references in, tree out.
struct BuilderEntry {
  std::string_view name;
  std::string_view sentence;
  std::string_view source;
  std::span<const OptionSpec> options;
  Bvh (*build)(std::vector<Reference> references, const OptionValues& options, const WorkLimit& limit);
};

/// All builders that make a Bvh. The same references give the same tree, byte for byte, for any number of threads.
std::span<const BuilderEntry> builders();

Bvh build_spatial_median(std::vector<Reference> references, const OptionValues& options, const WorkLimit& limit = {});
Bvh build_object_median(std::vector<Reference> references, const OptionValues& options, const WorkLimit& limit = {});
Bvh build_binned_sah(std::vector<Reference> references, const OptionValues& options, const WorkLimit& limit = {});
Bvh build_sweep_sah(std::vector<Reference> references, const OptionValues& options, const WorkLimit& limit = {});

}  // namespace kerf
