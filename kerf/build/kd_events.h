#pragma once

#include <array>
#include <bit>
#include <span>
#include <vector>

#include "kerf/build/kd_plane.h"
#include "kerf/references/reference.h"

namespace kerf {

/// Where a reference's box begins or ends along an axis, or lies flat across it, in one number whose order is that of a
/// sweep: by position, then ends, flat ones, begins, then the reference's number. Positions are never -0.
struct KdEvent {
  enum Kind : uint32_t { kEnd = 0, kFlat = 1, kBegin = 2 };

  uint64_t bits = 0;

  static constexpr uint32_t kReferenceMask = (1U << 30) - 1;

  KdEvent() = default;
  KdEvent(float position, Kind kind, uint32_t reference)
      : bits(uint64_t{ordered(position)} << 32 | uint32_t{kind} << 30 | reference) {}

  uint32_t reference() const { return static_cast<uint32_t>(bits) & kReferenceMask; }
  Kind kind() const { return static_cast<Kind>(static_cast<uint32_t>(bits) >> 30); }
  uint32_t ordered_position() const { return static_cast<uint32_t>(bits >> 32); }
  float position() const {
    const uint32_t o = ordered_position();
    return std::bit_cast<float>((o & kSign) != 0 ? o ^ kSign : ~o);
  }
  /// The same event of a reference that has another number now.
  KdEvent renumbered(uint32_t reference) const {
    KdEvent event;
    event.bits = (bits & ~uint64_t{kReferenceMask}) | reference;
    return event;
  }

  friend bool operator<(KdEvent a, KdEvent b) { return a.bits < b.bits; }

 private:
  static constexpr uint32_t kSign = 0x80000000U;

  /// Floats in the order of unsigned numbers.
  static uint32_t ordered(float x) {
    const auto bits = std::bit_cast<uint32_t>(x);
    return (bits & kSign) != 0 ? ~bits : bits | kSign;
  }
};
static_assert(sizeof(KdEvent) == 8);

/// Sorted along each axis.
using KdEvents = std::array<std::vector<KdEvent>, 3>;

/// Appends the events of a box, unsorted.
void append_events(const Box3f& box, uint32_t axis, uint32_t reference, std::vector<KdEvent>& events);

/// All events of the references, sorted.
KdEvents make_events(std::span<const Reference> references);

/// The cheapest plane strictly inside the cell at any event: one sweep along each axis. Equal costs go to the smaller
/// axis, then position.
KdPlane cheapest_plane(const KdEvents& events, size_t references, const Box3f& cell, const KdCosts& costs);

/// Where a reference goes when its cell is divided: its number below or above the plane, or both.
struct KdTarget {
  enum Side : uint32_t { kBelow = 1, kAbove = 2, kCut = 3 };

  uint32_t bits = 0;

  KdTarget() = default;
  KdTarget(Side side, uint32_t number) : bits(uint32_t{side} << 30 | number) {}
  uint32_t number() const { return bits & KdEvent::kReferenceMask; }
  uint32_t side() const { return bits >> 30; }
};

/// The events of the two halves of a cell in O(events) (Wald and Havran: On building fast kd-trees for ray tracing, and
/// on doing that in O(N log N), 2006): those of references that stay whole are handed on in their order, which
/// renumbering does not change, and those of cut ones are replaced by the events of their new boxes, sorted and merged.
struct KdEventHalves {
  KdEvents below, above;
};
struct KdCutBox {
  Box3f box;
  uint32_t reference;
};
KdEventHalves divide_events(const KdEvents& events, std::span<const KdTarget> targets,
                            std::span<const KdCutBox> cut_below, std::span<const KdCutBox> cut_above);

}  // namespace kerf
