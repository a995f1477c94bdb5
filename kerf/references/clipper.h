#pragma once

#include "kerf/references/reference.h"

namespace kerf {

/// The boxes of what of a reference's primitive lies below and above a plane, within the reference's own box. A side
/// that the primitive does not reach is empty.
using ClippedBoxes = CutBounds;

/// How a builder or splitter cuts primitives without knowing what they are: a plain function and what it works on.
/// It must cut the original primitive each time, not an earlier piece, and round boxes outward.
struct Clipper {
  ClippedBoxes (*function)(const void* data, const Reference& reference, uint32_t axis, float position) = nullptr;
  const void* data = nullptr;

  ClippedBoxes operator()(const Reference& reference, uint32_t axis, float position) const {
    return function(data, reference, axis, position);
  }
};

/// The clipper of Kerf's own geometries; the span must outlive it.
inline Clipper geometry_clipper(const std::span<const Geometry>& geometries) {
  return {[](const void* data, const Reference& reference, uint32_t axis, float position) {
            const auto& all = *static_cast<const std::span<const Geometry>*>(data);
            return cut_bounds(all[reference.geometry], reference.primitive, reference.bounds(), axis, position);
          },
          &geometries};
}

/// A temporary span would be gone when the clipper works.
Clipper geometry_clipper(std::span<const Geometry>&&) = delete;

}  // namespace kerf
