#pragma once

#include <memory>
#include <string>
#include <vector>

#include "kerf/io/scene_description.h"
#include "kerf/study/bench_subject.h"

namespace kerf {

/// What a scene is measured against, where this build knows Embree.
struct EmbreeRival {
  std::vector<std::unique_ptr<BenchSubject>> subjects;  ///< of each quality
  std::string settings;                                 ///< version, flags, huge pages and more, in lines
};

/// Embree over a scene, which must outlive it: builds of low, medium, high and robust high quality, `threads` threads.
/// Vertices and indices are shared; of the vertices it holds a copy, because Embree reads four bytes beyond the last.
/// Throws Error (invalid_option) where this build has no Embree or Embree cannot do what the scene asks for.
EmbreeRival embree_rival(const SceneDescription& scene, int threads);

}  // namespace kerf
