#include "kerf/trace/brute_force.h"

#include <algorithm>

#include "kerf/base/fp_environment.h"
#include "kerf/trace/leaf.h"

namespace kerf {
namespace {

constexpr size_t kBlock = 1024;  // triangles filtered at a time

}  // namespace

BruteForce::BruteForce(std::span<const Geometry> geometries, std::span<const LeafSlot> slots)
    : geometries_(geometries), kernels_(triangle_kernels()) {
  triangles_.reserve(slots.size());
  for (const LeafSlot& slot : slots) {
    if (const auto* mesh = std::get_if<TriangleMesh>(&geometries[slot.geometry()].shapes)) {
      triangles_.add(mesh->triangle(slot.primitive));
      triangle_slots_.push_back(slot);
    } else {
      other_slots_.push_back(slot);
    }
  }
  triangles_.finish();
}

template <bool kAny, class Counts>
Hit BruteForce::trace(const Ray& ray, Counts& counts) const {
  const StandardFloat standard;
  const PreparedRay prepared(ray);
  if (!prepared.valid) return {};
  Hit best;
  best.t = prepared.t_max;
  uint32_t candidates[kBlock + TriangleColumns::kPadding];
  for (size_t begin = 0; begin < triangle_slots_.size(); begin += kBlock) {
    const size_t end = std::min(begin + kBlock, triangle_slots_.size());
    counts.count_primitives(std::span(triangle_slots_).subspan(begin, end - begin));
    const size_t found = kernels_.filter(triangles_, prepared, begin, end, candidates);
    for (size_t i = 0; i < found; ++i) {
      if (test_primitive(geometries_, triangle_slots_[candidates[i]], prepared, best) && kAny) return best;
    }
  }
  for (const LeafSlot& slot : other_slots_) {
    if (test_primitive(geometries_, slot, prepared, best, counts) && kAny) return best;
  }
  return finished(best);
}

const TraceTable& brute_force_table() { return kTraceTable<BruteForce>; }

}  // namespace kerf
