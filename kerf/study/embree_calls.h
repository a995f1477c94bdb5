#pragma once

// Embree 3 or 4, whichever the build found: what differs between the two stands here. For .cpp files only.

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace kerf {

#if RTC_VERSION_MAJOR >= 4
inline constexpr bool kHasStreams = false;

/// Queries of one thread; `is_coherent`: the rays go side by side.
class EmbreeQueries {
 public:
  EmbreeQueries(RTCScene scene, bool is_coherent) : scene_(scene) {
    rtcInitIntersectArguments(&closest_);
    rtcInitOccludedArguments(&any_);
    closest_.flags = any_.flags = is_coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
  }

  void trace(RTCRayHit& ray) { rtcIntersect1(scene_, &ray, &closest_); }
  void trace(RTCRay& ray) { rtcOccluded1(scene_, &ray, &any_); }
  void trace(const int* valid, RTCRayHit8& rays) { rtcIntersect8(valid, scene_, &rays, &closest_); }
  void trace(const int* valid, RTCRay8& rays) { rtcOccluded8(valid, scene_, &rays, &any_); }
  void trace(const int* valid, RTCRayHit16& rays) { rtcIntersect16(valid, scene_, &rays, &closest_); }
  void trace(const int* valid, RTCRay16& rays) { rtcOccluded16(valid, scene_, &rays, &any_); }
  template <class R>
  void trace_stream(R*, size_t) {}  // Embree 4 has none

 private:
  RTCScene scene_;
  RTCIntersectArguments closest_;
  RTCOccludedArguments any_;
};
#else
inline constexpr bool kHasStreams = true;

/// Queries of one thread; `is_coherent`: the rays go side by side.
class EmbreeQueries {
 public:
  EmbreeQueries(RTCScene scene, bool is_coherent) : scene_(scene) {
    rtcInitIntersectContext(&context_);
    context_.flags = is_coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  }

  void trace(RTCRayHit& ray) { rtcIntersect1(scene_, &context_, &ray); }
  void trace(RTCRay& ray) { rtcOccluded1(scene_, &context_, &ray); }
  void trace(const int* valid, RTCRayHit8& rays) { rtcIntersect8(valid, scene_, &context_, &rays); }
  void trace(const int* valid, RTCRay8& rays) { rtcOccluded8(valid, scene_, &context_, &rays); }
  void trace(const int* valid, RTCRayHit16& rays) { rtcIntersect16(valid, scene_, &context_, &rays); }
  void trace(const int* valid, RTCRay16& rays) { rtcOccluded16(valid, scene_, &context_, &rays); }
  void trace_stream(RTCRayHit* rays, size_t count) {
    rtcIntersect1M(scene_, &context_, rays, static_cast<unsigned int>(count), sizeof(RTCRayHit));
  }
  void trace_stream(RTCRay* rays, size_t count) {
    rtcOccluded1M(scene_, &context_, rays, static_cast<unsigned int>(count), sizeof(RTCRay));
  }

 private:
  RTCScene scene_;
  RTCIntersectContext context_;
};
#endif

}  // namespace kerf
