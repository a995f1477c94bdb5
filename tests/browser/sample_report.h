#pragma once

#include "kerf/study/html_report.h"

namespace kerf {

/// A report as a large study gives one, of invented figures that say so: three scenes, fourteen rows of which some did
/// not finish, a second kind of rays, what a paper printed, a sweep, growth and pictures.
StudyReport sample_report();

/// One row of it, finished.
StudyResult sample_result(const std::string& scene, const std::string& row);

}  // namespace kerf
