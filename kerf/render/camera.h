#pragma once

#include "kerf/base/box3.h"
#include "kerf/geometry/ray.h"
#include "kerf/geometry/shapes.h"
#include "kerf/io/camera.h"

namespace kerf {

/// A camera that sees all of a box, from the front, the right and above; of a unit cube if the box is empty.
Camera framing_camera(const Box3f& bounds, double aspect, Vec3d up = {0, 1, 0}, double fov = 45);

/// The mask of camera rays, which do not see what is hidden from them, and of all other rays of a renderer.
inline constexpr uint32_t kCameraMask = 1, kIndirectMask = 2;

/// Rays through the pixels of a picture, of unit direction and with kCameraMask; pixel (0, 0) is at the top left.
class CameraRays {
 public:
  /// Throws Error(invalid_argument) where no picture is defined: eye equal to look_at, up along the view, fov outside
  /// (0, 180), a number that is not finite, a size of 0.
  CameraRays(const Camera& camera, uint32_t width, uint32_t height);

  /// Through a point of the picture, in pixels from its upper left corner: (0.5, 0.5) is the first one's centre.
  Ray operator()(double x, double y) const;
  /// Through the centre of a pixel.
  Ray center(uint32_t x, uint32_t y) const { return (*this)(x + 0.5, y + 0.5); }

 private:
  Vec3f origin_;
  Vec3d forward_, right_, down_;  ///< right_ and down_: from the centre of the picture to its border
  double width_, height_;
};

}  // namespace kerf
