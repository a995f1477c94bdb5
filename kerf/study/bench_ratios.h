#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kerf/study/bench_result.h"

namespace kerf {

/// The number of a kind of rays in a scene that has such rays.
std::optional<size_t> kind_number(const BenchScene& scene, std::string_view kind);

/// How many times as fast a row, by name(), is as Embree's `quality` one ray at a time; NaN where it is not known.
double ratio_to(const BenchScene& scene, std::string_view quality, std::string_view row, Feed feed,
                std::string_view kind);

/// The same beside high quality over all scenes with one kind of rays: the geometric mean; NaN where it is not known on
/// one of them.
double mean_ratio(std::span<const BenchScene> scenes, std::string_view row, Feed feed, std::string_view kind);

/// The same over all kinds and scenes on which it is known.
double overall_ratio(std::span<const BenchScene> scenes, std::string_view row, Feed feed);

/// Kerf's rows by name(), each once; of one quality where one is given.
std::vector<std::string> kerf_rows(std::span<const BenchScene> scenes, std::string_view quality);

/// Kerf's row whose overall_ratio() is greatest, of one quality where one is given; empty where there is none.
std::string best_row(std::span<const BenchScene> scenes, std::string_view quality, Feed feed);

/// The row that rays are judged by: the best_row() of preset `best` where there is one, else of all.
std::string judged_row(std::span<const BenchScene> scenes, Feed feed);

}  // namespace kerf
