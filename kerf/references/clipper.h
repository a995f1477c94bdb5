#pragma once

#include "kerf/references/reference.h"

namespace kerf {

/// The boxes of what of a reference's primitive lies below and above a plane, within the reference's own box. A side
/// that the primitive does not reach is empty.
using ClippedBoxes = CutBounds;

/// How a builder or splitter cuts primitives without knowing what they are: a plain function and what it works on.
/// It must cut the original primitive each time, not an earlier piece, and round boxes outward.
struct Clipper {
  using Function = ClippedBoxes (*)(const void* data, const Reference& reference, uint32_t axis, float position);

  Function function = nullptr;
  const void* data = nullptr;
  /// May be null; faster, for judging where to cut: its boxes need not be rounded outward, nor tight.
  Function rough = nullptr;

  ClippedBoxes operator()(const Reference& reference, uint32_t axis, float position) const {
    return function(data, reference, axis, position);
  }
  ClippedBoxes guess(const Reference& reference, uint32_t axis, float position) const {
    return (rough != nullptr ? rough : function)(data, reference, axis, position);
  }
};

/// The clipper of Kerf's own geometries; the span must outlive it.
Clipper geometry_clipper(const std::span<const Geometry>& geometries);

/// A temporary span would be gone when the clipper works.
Clipper geometry_clipper(std::span<const Geometry>&&) = delete;

/// A clipper for judging planes, some four times as fast as geometry_clipper(), and not for a tree: its boxes are not
/// rounded outward, and a part of a triangle is bounded as if nothing had been cut from it before, within the
/// reference's box. The span must outlive it.
Clipper rough_clipper(const std::span<const Geometry>& geometries);
Clipper rough_clipper(std::span<const Geometry>&&) = delete;

}  // namespace kerf
