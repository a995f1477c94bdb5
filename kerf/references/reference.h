#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "kerf/base/box3.h"
#include "kerf/geometry/geometry.h"

namespace kerf {

/// A box with the number of the primitive that is, or part of which is, inside: all that a builder sees. 32 bytes.
/// The caller's numbers stand in it from birth; splitting makes more references with the same numbers.
struct alignas(16) Reference {
  Vec3f lower;
  uint32_t geometry = 0;
  Vec3f upper;
  uint32_t primitive = 0;

  Box3f bounds() const { return {lower, upper}; }
  friend bool operator==(const Reference&, const Reference&) = default;
};
static_assert(sizeof(Reference) == 32);

/// At most this many primitives in a scene and references in a tree: a bit of each number is kept for flags.
inline constexpr size_t kMaxReferences = 0x7FFFFFFF;

/// The references of whole primitives, and which primitives got none.
struct PrimitiveReferences {
  std::vector<Reference> references;  ///< by geometry, then primitive
  size_t invalid = 0;                 ///< dropped: not finite or with a bad index; only with skip_invalid
  size_t degenerate = 0;              ///< without area, so never hit: dropped, unless kept
};

/// One reference for each primitive with an area, or with `movable` for each that has or may get one, in order. Throws
/// Error(invalid_geometry) that names the first invalid primitive and how many there are, unless `skip_invalid`;
/// Error(too_large) above kMaxReferences; Error(invalid_argument) for a null pointer. Parallel.
PrimitiveReferences make_references(std::span<const Geometry> geometries, bool skip_invalid = false,
                                    bool movable = false);

/// A primitive of several geometries.
struct PrimitiveNumber {
  uint32_t geometry = 0, primitive = 0;
  friend bool operator==(const PrimitiveNumber&, const PrimitiveNumber&) = default;
  friend bool operator<(const PrimitiveNumber& a, const PrimitiveNumber& b) {
    return a.geometry != b.geometry ? a.geometry < b.geometry : a.primitive < b.primitive;
  }
};

/// The primitives that make_references() refuses, in order, or all that it leaves out with skip_invalid and movable:
/// besides those the triangles with a vertex twice, which no move gives an area. Throws Error(invalid_argument) for a
/// null pointer. Parallel.
std::vector<PrimitiveNumber> find_invalid(std::span<const Geometry> geometries);
std::vector<PrimitiveNumber> find_left_out(std::span<const Geometry> geometries);

/// Throws Error(invalid_geometry) that names an invalid primitive, says what is wrong with it, that there are `count`
/// and what comes of it.
[[noreturn]] void refuse_invalid(std::span<const Geometry> geometries, PrimitiveNumber first, size_t count,
                                 std::string_view consequence);

}  // namespace kerf
