#pragma once

#include <cstdint>

#include "kerf/geometry/hit.h"
#include "kerf/geometry/ray.h"

namespace kerf {

/// The work that rays made. The same figures in every structure, added up over rays.
struct TraceCounts {
  uint64_t nodes = 0;       ///< nodes whose own box the ray enters, culled ones not: root, inner nodes, leaves
  uint64_t primitives = 0;  ///< primitive tests, repeats included
  uint64_t boxes = 0;       ///< box tests

  void count_nodes(uint64_t n) { nodes += n; }
  void count_primitives(uint64_t n) { primitives += n; }
  void count_boxes(uint64_t n) { boxes += n; }
};

/// Stands where counts are not wanted, and costs nothing.
struct NoCounts {
  void count_nodes(uint64_t) {}
  void count_primitives(uint64_t) {}
  void count_boxes(uint64_t) {}
};

/// The queries of one structure as plain functions of the data that they work on: picked once when a scene is built.
struct TraceTable {
  Hit (*closest)(const void* data, const Ray& ray);
  bool (*any)(const void* data, const Ray& ray);
  Hit (*closest_counted)(const void* data, const Ray& ray, TraceCounts& counts);
  bool (*any_counted)(const void* data, const Ray& ray, TraceCounts& counts);
};

/// The table of a tracer type: Tracer has `template <bool kAny, class Counts> Hit trace(const Ray&, Counts&) const`,
/// which for kAny may return any hit.
template <class Tracer>
inline constexpr TraceTable kTraceTable = {
    [](const void* data, const Ray& ray) {
      NoCounts counts;
      return static_cast<const Tracer*>(data)->template trace<false>(ray, counts);
    },
    [](const void* data, const Ray& ray) {
      NoCounts counts;
      return static_cast<bool>(static_cast<const Tracer*>(data)->template trace<true>(ray, counts));
    },
    [](const void* data, const Ray& ray, TraceCounts& counts) {
      return static_cast<const Tracer*>(data)->template trace<false>(ray, counts);
    },
    [](const void* data, const Ray& ray, TraceCounts& counts) {
      return static_cast<bool>(static_cast<const Tracer*>(data)->template trace<true>(ray, counts));
    },
};

}  // namespace kerf
