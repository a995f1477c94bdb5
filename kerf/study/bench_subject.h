#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "kerf/base/parallel.h"
#include "kerf/base/work_limit.h"
#include "kerf/geometry/hit.h"
#include "kerf/study/bench_result.h"
#include "kerf/study/study_rays.h"

namespace kerf {

/// Rays to be traced in one run. What it refers to outlives the run.
struct RaysToTrace {
  const StudyRays& rays;
  std::span<const uint32_t> order;  ///< see ray_order()
  int threads = 1;
  WorkLimit limit = {};  ///< looked at before each stretch

  /// Rays of a picture's pixels go side by side.
  bool are_coherent() const { return rays.kind == "primary"; }
};

/// One run over rays that are ready to be traced, in whatever form the engine wants them.
class BenchPass {
 public:
  virtual ~BenchPass() = default;
  /// What is timed; once. Throws Error (stopped) where the limit of its rays is reached.
  virtual void trace() = 0;
  /// After that: what each ray hit, in the caller's order; of any-hit rays only whether.
  virtual std::vector<Hit> hits() const = 0;
};

/// A structure that is measured.
class BenchSubject {
 public:
  virtual ~BenchSubject() = default;
  /// What it is, before it is built.
  virtual BenchRow describe() const = 0;
  /// Builds, and describes what came of it, with the seconds. Throws Error (stopped, too_large, invalid_option).
  virtual BenchRow build(const WorkLimit& limit) = 0;
  /// Builds once more and lets go of it; the seconds.
  virtual double time_build(const WorkLimit& limit) const = 0;
  virtual std::vector<Feed> feeds() const = 0;
  /// Not timed. After build().
  virtual std::unique_ptr<BenchPass> prepare(const RaysToTrace& rays, Feed feed) const = 0;
};

/// Rays that a thread takes at once.
inline constexpr size_t kStretch = 1024;

/// Calls f(begin, end) on stretches of `count` things, `width` rays each, on as many threads as are asked for: one is
/// the calling thread. The same loop for every engine.
template <class F>
void for_stretches(const RaysToTrace& rays, size_t count, size_t width, F&& f) {
  const size_t stretch = kStretch / width;
  if (rays.threads == 1) {
    for (size_t begin = 0; begin < count; begin += stretch) {
      rays.limit.check();
      f(begin, std::min(begin + stretch, count));
    }
    return;
  }
  with_threads(rays.threads, [&] {
    parallel_for(count, stretch, [&](size_t begin, size_t end) {
      rays.limit.check();
      f(begin, end);
    });
  });
}

}  // namespace kerf
