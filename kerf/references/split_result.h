#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kerf/references/reference.h"

namespace kerf {

/// How far to split was chosen for the scene: what was predicted, and why it ended there.
struct SplitChoice {
  /// A place on the curve of predicted cost against references. The cost is that of a random line through the scene:
  /// the way down the tree and the boxes of references that it crosses, log2(n) + sum of areas / area of the scene's
  /// box. It is of the leaves alone and leaves out what hides what, so it serves to compare and is no count.
  struct Step {
    double references_per_primitive = 1;
    double cost = 0;
  };
  std::vector<Step> curve;  ///< from no splitting to what was chosen, best cuts first
  std::string reason;       ///< a sentence
};

/// What a splitter makes.
struct SplitResult {
  std::vector<Reference> references;
  double limit = 0;     ///< that was used, in the splitter's own measure, such as sa_max; NaN: it has no single one
  bool capped = false;  ///< true: the limit asked for would have passed the cap or the room, so it was raised
  std::optional<SplitChoice> choice = std::nullopt;  ///< of automatic splitting
  bool short_of_room = false;                        ///< true: with the room that its cap allows it would have cut more
};

}  // namespace kerf
