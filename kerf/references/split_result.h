#pragma once

#include <vector>

#include "kerf/references/reference.h"

namespace kerf {

/// What a splitter makes.
struct SplitResult {
  std::vector<Reference> references;
  double limit = 0;     ///< that was used, in the splitter's own measure, such as sa_max
  bool capped = false;  ///< true: the limit asked for would have passed the cap, so it was raised
};

}  // namespace kerf
