#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "kerf/study/html_report.h"
#include "kerf/study/splitting_result.h"
#include "kerf/study/study.h"

namespace kerf::app {

/// One object for each scene, row and kind of rays.
nlohmann::ordered_json study_json(std::span<const StudyResult> results);

/// Everything measured of each scene, the goals of each and of all.
nlohmann::ordered_json splitting_json(std::span<const SplittingScene> scenes);

/// Writes a text whole or not at all; "-" is standard output.
void write_text(const std::string& path, const std::string& text);

/// The processor, the threads and the day: a line for a report.
std::string machine_line();

}  // namespace kerf::app
