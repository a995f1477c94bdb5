#pragma once

#include "kerf/trace/trace_bvh2.h"

namespace kerf {

/// Traces the rays of a batch in packets of consecutive ones, and a single ray as Bvh2Tracer does (Wald, Boulos,
/// Shirley: Ray Tracing Deformable Scenes using Dynamic Bounding Volume Hierarchies, 2007). A packet goes into a box
/// with the first of its rays that enters it and all behind that one: if the first of those that came into the parent
/// enters, no other is tested; if not, one test of intervals around all their origins and directions may show that all
/// miss; else they are tested in order. In a leaf each ray is tested by itself. Rays whose directions differ in a sign
/// get no test of intervals: they are traced rightly, and slowly.
///
/// Counts are of rays, so that they compare with single rays: `nodes` counts a node that the packet visits once for
/// each ray that enters its box (which counting finds out by tests that are not counted), `boxes` counts the tests of
/// one ray that the packet needs, and a test of intervals as one.
struct PacketTracer : Bvh2Tracer {
  static constexpr uint32_t kLargest = 16;

  uint32_t size = kLargest;  ///< rays in a packet, at most kLargest

  template <class Counts>
  void trace_batch(std::span<const Ray> rays, std::span<Hit> hits, Counts& counts) const;

  static const TraceTable& table();
};

}  // namespace kerf
