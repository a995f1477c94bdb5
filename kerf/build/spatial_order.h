#pragma once

#include "kerf/build/reference_order.h"
#include "kerf/build/spatial_bins.h"

namespace kerf {

/// References in an order with free places between them, for nodes whose references become more. Each half of a subset
/// has its own part of the free places, so what is done in one half never touches the other.
class SpatialOrder : public ReferenceOrder {
 public:
  /// With room for `room` references, at least as many as there are.
  SpatialOrder(std::vector<Reference> references, size_t room);

  using ReferenceOrder::arrange;
  using ReferenceOrder::partition;
  using ReferenceOrder::references;
  Subset whole() const { return whole_; }

  /// Cuts the references across the plane, but for those that cost less on one side only (reference unsplitting: Stich,
  /// Friedrich, Dietrich 2009, section 4.4). The plane's counts must fit into the subset's room.
  Halves cut(const Subset& subset, const SpatialPlane& plane, const Clipper& clipper);

  /// Divides the subset's free places between its halves, which stand side by side from its begin, and moves the right
  /// one up to where its own places begin. The rule looks at the two halves only: each gets as much as the lengths in
  /// it, the roots of its boxes' areas, add up to. By counts alone, a few walls beside many pebbles would get nothing.
  /// Lost places are divided so that both halves know what they would have got had none been lost.
  void make_room(const Subset& subset, Halves& halves);

 private:
  Subset measured(uint32_t begin, uint32_t end) const;
  double lengths(const Subset& subset) const;

  Subset whole_;
};

}  // namespace kerf
