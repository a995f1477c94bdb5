#pragma once

#include <span>
#include <string>

#include "kerf/study/bench_result.h"

namespace kerf {

/// Every row of each scene as a table to read, their geometric means over all scenes, and the goals.
std::string bench_text(std::span<const BenchScene> scenes);

}  // namespace kerf
