#pragma once

#include <span>
#include <vector>

#include "kerf/references/refine.h"
#include "kerf/references/refine_patterns.h"

namespace kerf {

/// Throws Error(invalid_option) for options that cannot be meant.
void check_options(const Refinement& options);

/// Cuts triangles to a limit that can be changed, all sides as their neighbours need it.
class Refiner {
 public:
  /// For the primitives of these references: triangles take part with their sides.
  Refiner(std::span<const Geometry> geometries, std::span<const Reference> whole, Refinement::Measure measure);

  /// The size of the largest primitive.
  double largest() const { return largest_; }

  void set_limit(double limit);

  /// Cuts triangle i of `whole`; emit(corners) is called for each piece and returns false to stop.
  template <class Emit>
  void cut(size_t i, Emit&& emit) const {
    const Triangle triangle = triangle_of(i);
    const std::array<RefinedCorner, 3> corners{
        {{to_double(triangle.a), 0, 0}, {to_double(triangle.b), 1, 0}, {to_double(triangle.c), 0, 1}}};
    std::array<uint32_t, 3> levels{};
    for (uint32_t s = 0; s < 3; ++s) {
      levels[s] = measure_ == Refinement::Measure::edge
                      ? levels_above(distance(corners[s], corners[(s + 1) % 3]), limit_, 2)
                      : side_levels_[sides_[i][s]];
    }
    const double longest = measure_ == Refinement::Measure::edge ? limit_ : std::numeric_limits<double>::infinity();
    const uint32_t inner = measure_ == Refinement::Measure::edge ? 0 : levels_above(sizes_[i], limit_, 4);
    TriangleCutter(longest, emit).cut(corners, levels, inner);
  }

 private:
  Triangle triangle_of(size_t i) const {
    return std::get<TriangleMesh>(geometries_[whole_[i].geometry].shapes).triangle(whole_[i].primitive);
  }

  std::span<const Geometry> geometries_;
  std::span<const Reference> whole_;
  Refinement::Measure measure_;
  double largest_ = 0, limit_ = std::numeric_limits<double>::infinity();
  // Only for an area limit:
  std::vector<double> sizes_;
  std::vector<std::array<uint32_t, 3>> sides_;  ///< the numbers of each triangle's sides
  std::vector<uint8_t> side_levels_;            ///< how often each side is halved
};

}  // namespace kerf
