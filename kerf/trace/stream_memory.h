#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <span>
#include <type_traits>

#include "kerf/trace/nearest_hit.h"
#include "kerf/trace/wide_ray.h"

namespace kerf {

/// What a node needs of a ray of a batch: one cache line.
struct alignas(64) StreamRay {
  float t_min;
  float limit;  ///< the farthest that it may still hit something; -infinity once it has hit anything and that is enough
  Float4 inverse, near_offset, far_offset;  ///< as in WideRay
};
static_assert(sizeof(StreamRay) == 64);

/// The rest of it.
struct StreamHit {
  WideRay wide;
  NearestHit nearest;
  const Ray* ray;

  StreamHit(const Ray& from, float largest_coordinate)
      : wide(from, largest_coordinate), nearest(from.t_max), ray(&from) {}
};
static_assert(std::is_trivially_destructible_v<StreamHit>);

/// Where the rays of a batch are worked on, some at a time; 2 MB, of which few rays touch little.
class StreamMemory {
 public:
  static constexpr uint32_t kMostRays = 4096, kMostChildren = 8;
  static constexpr uint32_t kListed = 32 * kMostRays;
  static constexpr uint32_t kPadding = 64;  // a vector may be read and written beyond the end

  /// Check is_there(): nothing is thrown.
  StreamMemory() : parts_(new (std::nothrow) Parts) {}

  bool is_there() const { return parts_ != nullptr; }
  const WideRay& make_ray(size_t i, const Ray& from, float largest_coordinate) {
    const auto* made = new (&parts_->hits[i * sizeof(StreamHit)]) StreamHit(from, largest_coordinate);
    const WideRay& wide = made->wide;
    parts_->rays[i] = {from.t_min, from.t_max, wide.inverse, wide.near_offset(), wide.far_offset()};
    return wide;
  }
  StreamRay* rays() { return parts_->rays; }
  StreamHit* hits() { return reinterpret_cast<StreamHit*>(parts_->hits); }
  uint8_t* octants() { return parts_->octants; }
  uint32_t* numbers() { return parts_->numbers; }
  uint32_t* lists() { return parts_->lists; }
  float* entries() { return parts_->entries; }
  uint8_t* entered() { return parts_->entered; }

 private:
  struct Parts {
    Parts() {}  // NOLINT(modernize-use-equals-default): that one would fill it with zeros
    StreamRay rays[kMostRays];
    alignas(alignof(StreamHit)) std::byte hits[kMostRays * sizeof(StreamHit)];
    alignas(64) float entries[(kMostRays + kPadding) * kMostChildren];
    uint32_t lists[kListed];
    uint32_t numbers[kMostRays];
    uint8_t octants[kMostRays];
    uint8_t entered[kMostRays + kPadding];
  };
  std::unique_ptr<Parts> parts_;
};

}  // namespace kerf
