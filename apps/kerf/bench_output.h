#pragma once

#include <nlohmann/json.hpp>
#include <span>

#include "kerf/study/bench_result.h"

namespace kerf::app {

/// One object for each scene, row, kind of rays and way to feed them.
nlohmann::ordered_json bench_json(std::span<const BenchScene> scenes);

}  // namespace kerf::app
