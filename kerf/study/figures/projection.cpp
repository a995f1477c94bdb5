#include "kerf/study/figures/projection.h"

#include <cmath>
#include <numbers>

#include "kerf/render/frame.h"

namespace kerf {

Projection::Projection(const Camera& camera, uint32_t width, uint32_t height)
    : eye_(to_double(to_float(camera.eye))), width_(width), height_(height) {  // rays begin at a float point
  forward_ = normalized(camera.look_at - camera.eye);
  const Vec3d side = normalized(cross(forward_, camera.up));
  const double half_height = std::tan(camera.fov * std::numbers::pi / 360);
  right_ = side * (half_height * width_ / height_);
  down_ = cross(forward_, side) * half_height;
}

Point2 Projection::operator()(Vec3d point) const {
  const Vec3d to = (point - eye_) / depth(point);
  return {(dot(to, right_) / dot(right_, right_) + 1) * width_ / 2,
          (dot(to, down_) / dot(down_, down_) + 1) * height_ / 2};
}

double Projection::distance_to_edge(Point2 pixel, Vec3d a, Vec3d b) const {
  // The plane through eye and edge cuts the plane of the picture in the line; its equation is linear in the pixel.
  const Vec3d normal = cross(a - eye_, b - eye_);
  const double along_x = dot(normal, right_) * 2 / width_, along_y = dot(normal, down_) * 2 / height_;
  const double value = dot(normal, forward_ - right_ - down_) + along_x * pixel.x + along_y * pixel.y;
  const double slope = std::sqrt(along_x * along_x + along_y * along_y);
  return slope > 0 ? std::abs(value) / slope : HUGE_VAL;
}

}  // namespace kerf
