#pragma once

#include <atomic>
#include <span>
#include <string_view>
#include <vector>

#include "kerf/base/options.h"
#include "kerf/base/work_limit.h"
#include "kerf/references/clipper.h"
#include "kerf/references/reference.h"
#include "kerf/tree/bvh.h"

namespace kerf {

/// What a builder tells besides the tree. From any thread; the same for any number of threads.
struct BuildNotes {
  /// It would have cut more references, as its own options allow, had BuildInput::most or the limit of bytes left room.
  std::atomic<bool> short_of_room = false;
};

/// What a builder works on. References alone are enough for one that does not split.
struct BuildInput {
  std::vector<Reference> references;
  Clipper clipper;  ///< for a builder that splits; its function may be null for the others
  WorkLimit limit;
  size_t most = kMaxReferences;  ///< references that it may make, whatever the options say
  BuildNotes* notes = nullptr;   ///< told, where there are any

  BuildInput() = default;
  BuildInput(std::vector<Reference> all, const Clipper& clip = {}, const WorkLimit& work = {})
      : references(std::move(all)), clipper(clip), limit(work) {}
};

/// One builder of the menu: references in, tree out.
struct BuilderEntry {
  std::string_view name;
  std::string_view sentence;
  std::string_view source;
  std::span<const OptionSpec> options;
  Bvh (*build)(BuildInput input, const OptionValues& options);
  /// What it takes for each reference at its peak, at most, the references and the tree included: by default what all
  /// top-down builders take, the parts of the tree beside the whole.
  size_t bytes_per_reference = sizeof(LeafSlot) + 4 * sizeof(BvhNode);
};

/// All builders that make a Bvh. The same references give the same tree, byte for byte, for any number of threads.
std::span<const BuilderEntry> builders();

/// What spatial_split takes for each reference that it has room for, at most.
inline constexpr size_t kSpatialSplitBytes = 152;

Bvh build_spatial_median(BuildInput input, const OptionValues& options);
Bvh build_object_median(BuildInput input, const OptionValues& options);
Bvh build_binned_sah(BuildInput input, const OptionValues& options);
Bvh build_sweep_sah(BuildInput input, const OptionValues& options);
Bvh build_spatial_split(BuildInput input, const OptionValues& options);
Bvh build_insertion(BuildInput input, const OptionValues& options);
Bvh build_random_top_down(BuildInput input, const OptionValues& options);
Bvh build_oversize_shelves(BuildInput input, const OptionValues& options);
Bvh build_lbvh(BuildInput input, const OptionValues& options);
Bvh build_ploc(BuildInput input, const OptionValues& options);

}  // namespace kerf
