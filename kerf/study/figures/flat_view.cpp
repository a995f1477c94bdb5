#include "kerf/study/figures/flat_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerf {

FlatView::FlatView(const Box3f& bounds, double panel_width) : margin_(0.03 * panel_width) {
  if (!bounds.is_empty()) {
    lower_ = to_double(bounds.lower);
    upper_ = to_double(bounds.upper);
  }
  const Vec3d extent = upper_ - lower_;
  if (extent.x < extent.y && extent.x < extent.z) across_ = kZ;
  if (extent.y < extent.x && extent.y < extent.z) up_ = kZ;
  const double room = panel_width - 2 * margin_, most = std::max(extent[across_], extent[up_]);
  if (most > 0) scale_ = room / most;
  width_ = std::max(extent[across_] * scale_, 0.1 * room) + 2 * margin_;
  height_ = std::max(extent[up_] * scale_, 0.1 * room) + 2 * margin_;
}

Point2 FlatView::operator()(Vec3d point) const {
  const double x = point[across_] - (lower_[across_] + upper_[across_]) / 2;
  const double y = point[up_] - (lower_[up_] + upper_[up_]) / 2;
  return {width_ / 2 + x * scale_, height_ / 2 - y * scale_};
}

bool is_flat(const Box3f& bounds) {
  if (bounds.is_empty()) return true;
  const Vec3d extent = to_double(bounds.upper) - to_double(bounds.lower);
  return std::min({extent.x, extent.y, extent.z}) <= 0.01 * largest(extent);
}

std::vector<Point2> flat_outline(const FlatView& view, const Geometry& geometry, uint32_t primitive) {
  std::vector<Point2> points;
  if (find_defect(geometry, primitive) != Defect::none) return points;
  if (const auto* mesh = std::get_if<TriangleMesh>(&geometry.shapes)) {
    const Triangle t = mesh->triangle(primitive);
    for (const Vec3f& corner : {t.a, t.b, t.c}) points.push_back(view(to_double(corner)));
  } else if (const auto* shapes = std::get_if<Strided<Parallelogram>>(&geometry.shapes)) {
    for (const Vec3d& corner : (*shapes)[primitive].corners()) points.push_back(view(corner));
  } else {
    const Box3f box = primitive_bounds(geometry, primitive);
    const Point2 a = view(to_double(box.lower)), b = view(to_double(box.upper));
    constexpr int kCorners = 48;
    for (int i = 0; i < kCorners; ++i) {
      const double angle = 2 * std::numbers::pi * i / kCorners;
      points.push_back((a + b) * 0.5 + Point2{std::cos(angle) * (b.x - a.x) / 2, std::sin(angle) * (a.y - b.y) / 2});
    }
  }
  return points;
}

void add_box(Drawing& drawing, Point2 at, const FlatView& view, const Box3f& box, const Paint& paint) {
  if (box.is_empty()) return;
  const Point2 a = at + view(to_double(box.lower)), b = at + view(to_double(box.upper));
  drawing.rectangle({std::min(a.x, b.x), std::min(a.y, b.y)}, {std::max(a.x, b.x), std::max(a.y, b.y)}, paint);
}

}  // namespace kerf
