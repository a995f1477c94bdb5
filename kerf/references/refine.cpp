#include "kerf/references/refine.h"

#include <cmath>
#include <optional>

#include "kerf/geometry/clip.h"
#include "kerf/references/fit_limit.h"
#include "kerf/references/middle_cut.h"
#include "kerf/references/refiner.h"
#include "kerf/references/split_each.h"

namespace kerf {
namespace {

/// The part of the original's box that points need which are off by no more than `error`.
Reference piece_of(const Reference& whole, Vec3d lower, Vec3d upper, double error) {
  const Vec3d reach{error, error, error};
  return with_box(whole, intersected(outward(lower - reach, upper + reach), whole.bounds()));
}

template <class Emit>
void cut_triangle(const Refiner& refiner, size_t i, const Reference& whole, Emit&& emit) {
  refiner.cut(i, [&](const std::array<RefinedCorner, 3>& c) {
    const Vec3d lower = min(min(c[0].position, c[1].position), c[2].position);
    const Vec3d upper = max(max(c[0].position, c[1].position), c[2].position);
    return emit(piece_of(whole, lower, upper, std::max({c[0].error, c[1].error, c[2].error})));
  });
}

/// Halved along both sides until they are short enough, or until the cells are small enough.
template <class Emit>
void cut_parallelogram(const Parallelogram& shape, const Refinement& options, const Reference& whole, Emit&& emit) {
  const Vec3d corner = to_double(cleaned(shape.corner)), u = to_double(cleaned(shape.u)),
              v = to_double(cleaned(shape.v));
  const Vec3d normal = cross(u, v);
  uint32_t along_u = levels_above(std::sqrt(dot(normal, normal)), options.limit, 4), along_v = along_u;
  if (options.measure == Refinement::Measure::edge) {
    along_u = levels_above(std::sqrt(dot(u, u)), options.limit, 2);
    along_v = levels_above(std::sqrt(dot(v, v)), options.limit, 2);
  }
  if (along_u == 0 && along_v == 0) {
    emit(whole);
    return;
  }
  const uint64_t cells_u = uint64_t{1} << along_u, cells_v = uint64_t{1} << along_v;
  const Vec3d step_u = u / static_cast<double>(cells_u), step_v = v / static_cast<double>(cells_v);
  // Two sums are rounded on the way to a corner of a cell.
  const double error = 0x1p-51 * (largest(abs(corner)) + largest(abs(u)) + largest(abs(v)));
  for (uint64_t j = 0; j < cells_v; ++j) {
    for (uint64_t i = 0; i < cells_u; ++i) {
      const Vec3d p = corner + step_u * static_cast<double>(i) + step_v * static_cast<double>(j);
      const Vec3d lower = p + min(step_u, Vec3d{}) + min(step_v, Vec3d{});
      const Vec3d upper = p + max(step_u, Vec3d{}) + max(step_v, Vec3d{});
      if (!emit(piece_of(whole, lower, upper, error))) return;
    }
  }
}

/// The references that the limit gives, or nothing if they are more than `most`.
std::optional<std::vector<Reference>> refine_all(std::span<const Geometry> geometries, std::span<const Reference> whole,
                                                 Refiner& refiner, const Refinement& options, size_t most,
                                                 const WorkLimit& limit) {
  refiner.set_limit(options.limit);
  return split_each(whole, most, limit, [&](const Reference& reference, const auto& emit) {
    const auto& shapes = geometries[reference.geometry].shapes;
    if (std::holds_alternative<TriangleMesh>(shapes)) {
      cut_triangle(refiner, static_cast<size_t>(&reference - whole.data()), reference, emit);
    } else if (const auto* parallelograms = std::get_if<Strided<Parallelogram>>(&shapes)) {
      cut_parallelogram((*parallelograms)[reference.primitive], options, reference, emit);
    } else {
      emit(reference);
    }
  });
}

}  // namespace

SplitResult refine(std::span<const Geometry> geometries, std::span<const Reference> whole, const Refinement& options,
                   const WorkLimit& limit) {
  check_options(options);
  limit.check(whole.size_bytes());
  if (std::isinf(options.limit)) return {{whole.begin(), whole.end()}, options.limit, false};
  Refiner refiner(geometries, whole, options.measure);
  const size_t most = most_references(whole.size(), options.cap);
  const auto try_limit = [&](double size) {
    limit.check();
    return refine_all(geometries, whole, refiner, {options.measure, size, options.cap}, most, limit);
  };
  if (auto references = try_limit(options.limit)) return {std::move(*references), options.limit, false};
  SplitResult result{{whole.begin(), whole.end()}, 0, true};
  result.limit =
      lower_to_fit(refiner.largest(), options.limit, whole.size(), most, [&](double size) -> std::optional<size_t> {
        const HeldBytes held(result.references.capacity() * sizeof(Reference));
        auto finer = try_limit(size);
        if (!finer) return std::nullopt;
        result.references = std::move(*finer);
        return result.references.size();
      });
  return result;
}

}  // namespace kerf
