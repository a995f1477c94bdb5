#pragma once

#include <memory>
#include <string>

#include "kerf/io/scene_description.h"
#include "kerf/study/bench_subject.h"
#include "kerf/study/row_measure.h"

namespace kerf {

/// A pipeline over a scene; both must outlive it. Throws Error (invalid_option) for what is no pipeline.
std::unique_ptr<BenchSubject> kerf_subject(const SceneDescription& scene, const std::string& pipeline,
                                           const MeasureOptions& options);

}  // namespace kerf
