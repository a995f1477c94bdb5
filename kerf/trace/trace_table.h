#pragma once

#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "kerf/geometry/hit.h"
#include "kerf/geometry/ray.h"
#include "kerf/tree/bvh.h"

namespace kerf {

/// A count for each primitive, by geometry, as slots number them.
using PrimitiveTally = std::vector<std::vector<uint64_t>>;

/// The work that rays made. The same figures in every structure, added up over rays.
struct TraceCounts {
  uint64_t nodes = 0;       ///< nodes whose own box the ray enters, culled ones not: root, inner nodes, leaves
  uint64_t primitives = 0;  ///< primitive tests, repeats included
  uint64_t boxes = 0;       ///< box tests
  static constexpr bool kCounts = true;
  PrimitiveTally* tests = nullptr;  ///< where given: the primitive tests of each primitive, added up

  void count_nodes(uint64_t n) { nodes += n; }
  void count_primitives(std::span<const LeafSlot> tested) {
    primitives += tested.size();
    if (tests == nullptr) return;
    for (const LeafSlot& slot : tested) ++(*tests)[slot.geometry()][slot.primitive];
  }
  void count_boxes(uint64_t n) { boxes += n; }
};

/// Stands where counts are not wanted, and costs nothing.
struct NoCounts {
  static constexpr bool kCounts = false;
  void count_nodes(uint64_t) {}
  void count_primitives(std::span<const LeafSlot>) {}
  void count_boxes(uint64_t) {}
};

/// The queries of one structure as plain functions of the data that they work on: picked once when a scene is built.
struct TraceTable {
  Hit (*closest)(const void* data, const Ray& ray);
  bool (*any)(const void* data, const Ray& ray);
  Hit (*closest_counted)(const void* data, const Ray& ray, TraceCounts& counts);
  bool (*any_counted)(const void* data, const Ray& ray, TraceCounts& counts);
  /// One hit for each ray, the spans of equal length.
  void (*closest_batch)(const void* data, std::span<const Ray> rays, std::span<Hit> hits);
  void (*closest_batch_counted)(const void* data, std::span<const Ray> rays, std::span<Hit> hits, TraceCounts& counts);
  /// For each ray whether it hits anything: 1 or 0.
  void (*any_batch)(const void* data, std::span<const Ray> rays, std::span<uint8_t> hits);
  void (*any_batch_counted)(const void* data, std::span<const Ray> rays, std::span<uint8_t> hits, TraceCounts& counts);
};

namespace detail {

/// A tracer of other data than itself has `static Tracer at(const void* data)`.
template <class Tracer>
decltype(auto) tracer_at(const void* data) {
  if constexpr (requires { Tracer::at(data); }) {
    return Tracer::at(data);
  } else {
    return *static_cast<const Tracer*>(data);
  }
}

/// What a query of one ray tells: the closest hit, or whether there is any.
template <bool kAny>
using QueryResult = std::conditional_t<kAny, bool, Hit>;

/// A tracer may have `template <bool kAny> static QueryResult<kAny> query(const void* data, const Ray&)` itself, which
/// saves a call.
template <class Tracer, bool kAny>
constexpr auto query_of() -> QueryResult<kAny> (*)(const void*, const Ray&) {
  if constexpr (requires { &Tracer::template query<kAny>; }) {
    return &Tracer::template query<kAny>;
  } else {
    return [](const void* data, const Ray& ray) {
      NoCounts counts;
      return static_cast<QueryResult<kAny>>(tracer_at<Tracer>(data).template trace<kAny>(ray, counts));
    };
  }
}

/// A tracer that does better with many rays at once has `template <class Counts> void trace_batch(std::span<const Ray>,
/// std::span<Result>, Counts&) const`, where Result is Hit for the closest or uint8_t for any, or both.
template <class Tracer, class Result, class Counts>
void trace_batch(const Tracer& tracer, std::span<const Ray> rays, std::span<Result> results, Counts& counts) {
  if constexpr (requires { tracer.trace_batch(rays, results, counts); }) {
    tracer.trace_batch(rays, results, counts);
  } else if constexpr (std::is_same_v<Result, Hit>) {
    for (size_t i = 0; i < rays.size(); ++i) results[i] = tracer.template trace<false>(rays[i], counts);
  } else {
    for (size_t i = 0; i < rays.size(); ++i) results[i] = tracer.template trace<true>(rays[i], counts) ? 1 : 0;
  }
}

}  // namespace detail

/// The table of a tracer type: Tracer has `template <bool kAny, class Counts> Hit trace(const Ray&, Counts&) const`,
/// which for kAny may return any hit.
template <class Tracer>
inline constexpr TraceTable kTraceTable = {
    detail::query_of<Tracer, false>(),
    detail::query_of<Tracer, true>(),
    [](const void* data, const Ray& ray, TraceCounts& counts) {
      return detail::tracer_at<Tracer>(data).template trace<false>(ray, counts);
    },
    [](const void* data, const Ray& ray, TraceCounts& counts) {
      return static_cast<bool>(detail::tracer_at<Tracer>(data).template trace<true>(ray, counts));
    },
    [](const void* data, std::span<const Ray> rays, std::span<Hit> hits) {
      NoCounts counts;
      detail::trace_batch(detail::tracer_at<Tracer>(data), rays, hits, counts);
    },
    [](const void* data, std::span<const Ray> rays, std::span<Hit> hits, TraceCounts& counts) {
      detail::trace_batch(detail::tracer_at<Tracer>(data), rays, hits, counts);
    },
    [](const void* data, std::span<const Ray> rays, std::span<uint8_t> hits) {
      NoCounts counts;
      detail::trace_batch(detail::tracer_at<Tracer>(data), rays, hits, counts);
    },
    [](const void* data, std::span<const Ray> rays, std::span<uint8_t> hits, TraceCounts& counts) {
      detail::trace_batch(detail::tracer_at<Tracer>(data), rays, hits, counts);
    },
};

}  // namespace kerf
