#pragma once

#include <atomic>
#include <span>
#include <vector>

#include "kerf/study/html_report.h"
#include "kerf/study/study.h"

namespace kerf {

/// What a report shows of a scene: the wireframe on the shaded model, and heat maps of nodes and triangles per ray in
/// the first row and in the fastest one. `results` are the scene's. Nothing after `cancelled` became true. Throws Error
/// as build_scene() does.
std::vector<ReportPicture> study_pictures(const StudyScene& scene, std::span<const StudyResult> results,
                                          const StudyOptions& options);

}  // namespace kerf
