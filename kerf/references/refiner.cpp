#include "kerf/references/refiner.h"

#include <algorithm>
#include <string>

#include "kerf/base/error.h"
#include "kerf/base/work_limit.h"
#include "kerf/references/welded_sides.h"

namespace kerf {
namespace {

double length(Vec3d v) { return std::sqrt(dot(v, v)); }

double size_of(const Triangle& t, Refinement::Measure measure) {
  const Vec3d a = to_double(t.a), b = to_double(t.b), c = to_double(t.c);
  if (measure == Refinement::Measure::area) return 0.5 * length(cross(b - a, c - a));
  return std::max({length(b - a), length(c - b), length(a - c)});
}

double size_of(const Parallelogram& p, Refinement::Measure measure) {
  const Vec3d u = to_double(p.u), v = to_double(p.v);
  return measure == Refinement::Measure::area ? length(cross(u, v)) : std::max(length(u), length(v));
}

}  // namespace

void check_options(const Refinement& options) {
  if (!(options.limit > 0)) {
    throw Error(ErrorCode::invalid_option, "refine",
                "the limit is " + std::to_string(options.limit) + "; it must be above 0 (inf: no refinement)");
  }
  if (!(options.cap >= 1)) {
    throw Error(ErrorCode::invalid_option, "refine",
                "cap is " + std::to_string(options.cap) + "; it must be at least 1 reference per primitive");
  }
}

Refiner::Refiner(std::span<const Geometry> geometries, std::span<const Reference> whole, Refinement::Measure measure)
    : geometries_(geometries), whole_(whole), measure_(measure) {
  const bool by_area = measure == Refinement::Measure::area;
  if (by_area) {
    sizes_.resize(whole.size());
    sides_.resize(whole.size());
  }
  WeldedSides welded;
  LimitWatch watch;
  for (size_t i = 0; i < whole.size(); ++i) {
    watch.step();
    const auto& shapes = geometries[whole[i].geometry].shapes;
    if (std::holds_alternative<TriangleMesh>(shapes)) {
      const Triangle triangle = triangle_of(i);
      const double size = size_of(triangle, measure);
      largest_ = std::max(largest_, size);
      if (!by_area) continue;
      sizes_[i] = size;
      sides_[i] = welded.add(triangle).sides;
    } else if (const auto* parallelograms = std::get_if<Strided<Parallelogram>>(&shapes)) {
      largest_ = std::max(largest_, size_of((*parallelograms)[whole[i].primitive], measure));
    }
  }
  side_levels_.resize(welded.side_count());
}

void Refiner::set_limit(double limit) {
  limit_ = limit;
  if (measure_ != Refinement::Measure::area) return;
  std::fill(side_levels_.begin(), side_levels_.end(), uint8_t{0});
  LimitWatch watch;
  for (size_t i = 0; i < whole_.size(); ++i) {
    watch.step();
    if (!(sizes_[i] > limit)) continue;
    const auto levels = static_cast<uint8_t>(levels_above(sizes_[i], limit, 4));
    for (const uint32_t side : sides_[i]) side_levels_[side] = std::max(side_levels_[side], levels);
  }
}

}  // namespace kerf
