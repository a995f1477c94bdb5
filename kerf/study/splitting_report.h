#pragma once

#include <span>
#include <string>

#include "kerf/study/splitting_result.h"

namespace kerf {

/// What a report on splitting shows.
struct SplittingReport {
  std::string title;
  std::string command;  ///< that made it
  std::string machine;  ///< processor, threads, date: a line
  std::span<const SplittingScene> scenes;
};

/// The report as one HTML page that needs nothing else, as html_report() makes: the goals over all scenes, all scenes
/// beside each other, and for each its curves, figures and goals.
std::string splitting_report(const SplittingReport& report);

}  // namespace kerf
