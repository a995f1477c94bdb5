#pragma once

#include <memory>

#include "kerf/study/bench_subject.h"
#include "kerf/study/embree_calls.h"

// For .cpp files only, where Embree was found.

namespace kerf {

/// While one lives, this thread flushes denormals to zero and takes them for zero, as Embree recommends; then the
/// setting from before returns. Nothing where the processor is not an x86.
class FlushedDenormals {
 public:
  FlushedDenormals();
  ~FlushedDenormals();
  FlushedDenormals(const FlushedDenormals&) = delete;
  FlushedDenormals& operator=(const FlushedDenormals&) = delete;

 private:
  [[maybe_unused]] uint32_t saved_ = 0;
};

/// Rays in Embree's own format, to be traced through its scene.
std::unique_ptr<BenchPass> embree_pass(RTCScene scene, const RaysToTrace& rays, Feed feed);

}  // namespace kerf
