#include "kerf/study/embree_pass.h"

#include <algorithm>
#include <array>
#include <type_traits>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace kerf {
namespace {

/// The ray of what Embree traces: a ray alone where it is asked whether anything is hit, else with room for the hit.
template <class R>
auto& ray_of(R& r) {
  if constexpr (requires { r.ray; }) {
    return r.ray;
  } else {
    return r;
  }
}

/// One number of a ray or of a packet's ray `lane`.
template <class T>
T& lane_of(T& number, size_t) {
  return number;
}
template <class T, size_t kWidth>
T& lane_of(T (&numbers)[kWidth], size_t lane) {
  return numbers[lane];
}

template <class R>
void set_ray(R& to, size_t lane, const Ray& from) {
  auto& ray = ray_of(to);
  lane_of(ray.org_x, lane) = from.origin.x;
  lane_of(ray.org_y, lane) = from.origin.y;
  lane_of(ray.org_z, lane) = from.origin.z;
  lane_of(ray.tnear, lane) = from.t_min;
  lane_of(ray.dir_x, lane) = from.direction.x;
  lane_of(ray.dir_y, lane) = from.direction.y;
  lane_of(ray.dir_z, lane) = from.direction.z;
  lane_of(ray.time, lane) = 0;
  lane_of(ray.tfar, lane) = from.t_max;
  lane_of(ray.mask, lane) = from.mask;
  lane_of(ray.id, lane) = lane_of(ray.flags, lane) = 0;
  if constexpr (requires { to.hit; }) {
    lane_of(to.hit.geomID, lane) = RTC_INVALID_GEOMETRY_ID;
    lane_of(to.hit.instID[0], lane) = RTC_INVALID_GEOMETRY_ID;
  }
}

template <class R>
Hit hit_of(const R& from, size_t lane) {
  if constexpr (requires { from.hit; }) {
    const auto& hit = from.hit;
    if (lane_of(hit.geomID, lane) == RTC_INVALID_GEOMETRY_ID) return {};
    return {lane_of(from.ray.tfar, lane), lane_of(hit.u, lane),      lane_of(hit.v, lane),
            lane_of(hit.primID, lane),    lane_of(hit.geomID, lane), kNone};
  } else {
    return lane_of(from.tfar, lane) < 0 ? Hit{0, 0, 0, 0, 0, kNone} : Hit{};  // what is occluded ends at -infinity
  }
}

/// R: RTCRayHit or RTCRay, or packets of kWidth of them.
template <class R, size_t kWidth>
class EmbreePass : public BenchPass {
 public:
  EmbreePass(RTCScene scene, const RaysToTrace& rays, bool is_stream)
      : scene_(scene),
        rays_(rays),
        is_stream_(is_stream),
        count_(rays.rays.rays.size()),
        packets_((count_ + kWidth - 1) / kWidth) {
    for (size_t i = 0; i < packets_.size() * kWidth; ++i) {
      set_ray(packets_[i / kWidth], i % kWidth, rays.rays.rays[number(std::min(i, count_ - 1))]);
    }
  }

  void trace() override {
    for_stretches(rays_, packets_.size(), kWidth, [&](size_t begin, size_t end) {
      const FlushedDenormals flushed;
      EmbreeQueries queries(scene_, rays_.are_coherent());
      if constexpr (kWidth == 1) {
        if (is_stream_) return queries.trace_stream(packets_.data() + begin, end - begin);
        for (size_t i = begin; i < end; ++i) queries.trace(packets_[i]);
      } else {
        alignas(64) std::array<int, kWidth> valid;
        valid.fill(-1);
        for (size_t i = begin; i < end; ++i) {
          const size_t filled = std::min(kWidth, count_ - i * kWidth);
          if (filled < kWidth) std::fill(valid.begin() + static_cast<std::ptrdiff_t>(filled), valid.end(), 0);
          queries.trace(valid.data(), packets_[i]);
        }
      }
    });
  }

  std::vector<Hit> hits() const override {
    std::vector<Hit> all(count_);
    for (size_t i = 0; i < count_; ++i) all[number(i)] = hit_of(packets_[i / kWidth], i % kWidth);
    return all;
  }

 private:
  /// Of the ray at place i.
  size_t number(size_t i) const { return rays_.order.empty() ? i : rays_.order[i]; }

  RTCScene scene_;
  RaysToTrace rays_;  // its order is empty for the caller's
  bool is_stream_;
  size_t count_;
  std::vector<R> packets_;
};

template <class Closest, class Any, size_t kWidth>
std::unique_ptr<BenchPass> pass_of(RTCScene scene, const RaysToTrace& rays, bool is_stream) {
  if (rays.rays.any_hit) return std::make_unique<EmbreePass<Any, kWidth>>(scene, rays, is_stream);
  return std::make_unique<EmbreePass<Closest, kWidth>>(scene, rays, is_stream);
}

}  // namespace

#if defined(__SSE2__)
constexpr uint32_t kFlush = 0x8040;  // flush to zero, denormals are zero

FlushedDenormals::FlushedDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | kFlush); }
FlushedDenormals::~FlushedDenormals() { _mm_setcsr((_mm_getcsr() & ~kFlush) | (saved_ & kFlush)); }
#else
FlushedDenormals::FlushedDenormals() = default;
FlushedDenormals::~FlushedDenormals() = default;
#endif

std::unique_ptr<BenchPass> embree_pass(RTCScene scene, const RaysToTrace& rays, Feed feed) {
  RaysToTrace some = rays;
  if (feed == Feed::loop) some.order = {};
  if (feed == Feed::packets_8) return pass_of<RTCRayHit8, RTCRay8, 8>(scene, some, false);
  if (feed == Feed::packets_16) return pass_of<RTCRayHit16, RTCRay16, 16>(scene, some, false);
  return pass_of<RTCRayHit, RTCRay, 1>(scene, some, feed == Feed::stream);
}

}  // namespace kerf
