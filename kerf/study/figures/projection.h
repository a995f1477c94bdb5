#pragma once

#include <optional>

#include "kerf/render/camera.h"
#include "kerf/study/figures/drawing.h"

namespace kerf {

/// Where points and edges lie in the picture of a camera: the inverse of CameraRays.
class Projection {
 public:
  /// The camera must be one that CameraRays takes.
  Projection(const Camera& camera, uint32_t width, uint32_t height);

  Vec3d eye() const { return eye_; }
  /// How far a point lies in front of the camera, along the view.
  double depth(Vec3d point) const { return dot(point - eye_, forward_); }
  /// The point of the picture, in pixels from its upper left corner, where a point in front of the camera is seen.
  Point2 operator()(Vec3d point) const;
  /// How far, in pixels, a point of the picture is from the line that the edge through a and b is seen as; infinite
  /// where the edge is seen as a point. Right for edges that go behind the camera too.
  double distance_to_edge(Point2 pixel, Vec3d a, Vec3d b) const;

 private:
  Vec3d eye_, forward_, right_, down_;
  double width_, height_;
};

}  // namespace kerf
