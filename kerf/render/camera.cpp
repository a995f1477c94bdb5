#include "kerf/render/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kerf/base/error.h"

namespace kerf {
namespace {

double length(Vec3d v) { return std::sqrt(dot(v, v)); }

[[noreturn]] void refuse(const char* sentence) { throw Error(ErrorCode::invalid_argument, "camera", sentence); }

}  // namespace

Camera framing_camera(const Box3f& bounds, double aspect, Vec3d up, double fov) {
  Camera camera;
  camera.up = up;
  camera.fov = fov;
  const bool is_empty = bounds.is_empty();
  const Vec3d lower = is_empty ? Vec3d{-0.5, -0.5, -0.5} : to_double(bounds.lower);
  const Vec3d upper = is_empty ? Vec3d{0.5, 0.5, 0.5} : to_double(bounds.upper);
  camera.look_at = (lower + upper) * 0.5;
  const Vec3d to_eye = std::abs(up.z) > std::abs(up.y) ? Vec3d{0.6, -1, 0.45} : Vec3d{0.6, 0.45, 1};
  const Vec3d backward = to_eye / length(to_eye);
  const Vec3d side = cross(up, backward), right = side / length(side), above = cross(backward, right);
  const double tangent_up = std::tan(fov * std::numbers::pi / 360), tangent_right = tangent_up * aspect;
  // From each corner of the box on, both fields of view must be wide enough.
  double distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d p{(corner & 1) != 0 ? upper.x : lower.x, (corner & 2) != 0 ? upper.y : lower.y,
                  (corner & 4) != 0 ? upper.z : lower.z};
    const Vec3d offset = p - camera.look_at;
    const double needed =
        std::max(std::abs(dot(offset, right)) / tangent_right, std::abs(dot(offset, above)) / tangent_up);
    distance = std::max(distance, needed + dot(offset, backward));
  }
  if (!(distance > 0)) distance = std::max(1.0, largest(abs(camera.look_at))) * 1e-3;
  constexpr double kMargin = 1.05;
  camera.eye = camera.look_at + backward * (distance * kMargin);
  return camera;
}

CameraRays::CameraRays(const Camera& camera, uint32_t width, uint32_t height)
    : origin_(to_float(camera.eye)), width_(width), height_(height) {
  if (width == 0 || height == 0) refuse("the picture must have at least one pixel");
  if (!(camera.fov > 0 && camera.fov < 180)) refuse("fov must lie between 0 and 180 degrees");
  const Vec3d view = camera.look_at - camera.eye;
  if (!std::isfinite(length(view)) || !std::isfinite(length(camera.up)) || !is_coordinate(origin_)) {
    refuse("eye, look-at and up must be finite");
  }
  if (!(length(view) > 0)) refuse("eye and look-at must differ");
  forward_ = view / length(view);
  const Vec3d side = cross(forward_, camera.up);
  if (!(length(side) > 1e-9 * length(camera.up))) refuse("up must not point along the view");
  const double half_height = std::tan(camera.fov * std::numbers::pi / 360);
  right_ = side * (half_height * width_ / height_ / length(side));
  down_ = cross(forward_, side) * (half_height / length(side));
}

Ray CameraRays::operator()(double x, double y) const {
  const Vec3d through = forward_ + right_ * (x / width_ * 2 - 1) + down_ * (y / height_ * 2 - 1);
  Ray ray;
  ray.origin = origin_;
  ray.direction = to_float(through / length(through));
  ray.mask = kCameraMask;
  return ray;
}

}  // namespace kerf
