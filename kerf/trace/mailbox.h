#pragma once

#include <cstdint>

#include "kerf/tree/bvh.h"

namespace kerf {

/// The primitives that a ray was tested against lately, so that one with several references is tested once (inverse
/// mailboxing: Shevtsov, Soupikov, Kapustin: Highly Parallel Fast KD-tree Construction for Interactive Ray Tracing of
/// Dynamic Scenes, 2007). It lives on the ray's stack, so any number of threads may trace. A primitive is tested again
/// if another one took its place in between, which costs a test and changes no hit: the more places, the less often,
/// and the longer it takes to set them up for a ray.
template <uint32_t kPlaces>
class MailboxOf {
 public:
  MailboxOf() {
    for (LeafSlot& slot : slots_) slot = {kNobody, kNobody};
  }

  /// Whether the primitive was tested before; from now on it was. Only asked for slots with kRepeated.
  bool has_seen(const LeafSlot& slot) {
    LeafSlot& place = slots_[(slot.primitive ^ slot.geometry_bits) % kPlaces];
    if (place == slot) return true;
    place = slot;
    return false;
  }

 private:
  static constexpr uint32_t kNobody = 0xFFFFFFFF;  // no scene has so many primitives

  LeafSlot slots_[kPlaces];
};

using Mailbox = MailboxOf<64>;

/// Stands where repeats are tested again.
struct NoMailbox {
  static bool has_seen(const LeafSlot&) { return false; }
};

}  // namespace kerf
