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
  double radius = length(upper - lower) * 0.5;
  if (!(radius > 0)) radius = std::max(1.0, largest(abs(camera.look_at))) * 1e-3;
  // The sphere around the box must fit the narrower of the two fields of view.
  const double half_vertical = fov * std::numbers::pi / 360;
  const double half = std::min(half_vertical, std::atan(std::tan(half_vertical) * aspect));
  const Vec3d to_eye = std::abs(up.z) > std::abs(up.y) ? Vec3d{0.6, -1, 0.45} : Vec3d{0.6, 0.45, 1};
  camera.eye = camera.look_at + to_eye * (radius / std::sin(half) / length(to_eye));
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

Ray CameraRays::operator()(uint32_t x, uint32_t y) const {
  const Vec3d through = forward_ + right_ * ((x + 0.5) / width_ * 2 - 1) + down_ * ((y + 0.5) / height_ * 2 - 1);
  Ray ray;
  ray.origin = origin_;
  ray.direction = to_float(through / length(through));
  return ray;
}

}  // namespace kerf
