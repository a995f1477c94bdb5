#pragma once

#include <span>
#include <string>
#include <vector>

#include "kerf/study/splitting_result.h"

namespace kerf {

/// What automatic splitting does to a scene, in sentences: references, time, memory, work, ray time, and its reason.
std::vector<std::string> splitting_sentences(const SplittingScene& scene);

/// The rows of each scene as a table to read, what was left out, the goals of each scene and of all.
std::string splitting_text(std::span<const SplittingScene> scenes);

/// Comma-separated values under a row of names: a line for each scene, turn, row and kind of rays. Fields of rows that
/// did not finish are empty.
std::string splitting_csv(std::span<const SplittingScene> scenes);

/// A row in few words: "auto", "budget 1.2".
std::string row_name(const SplittingRow& row);

}  // namespace kerf
