#pragma once

#include <span>

#include "kerf/scene/scene.h"
#include "kerf/study/figures/drawing.h"
#include "kerf/study/figures/tree_boxes.h"

namespace kerf {

/// A scene seen along the axis of its least extent, without perspective, as large as fits a panel.
class FlatView {
 public:
  /// `panel_width`: also the largest height. An empty box is seen as a point.
  FlatView(const Box3f& bounds, double panel_width);

  double width() const { return width_; }
  double height() const { return height_; }
  /// In a panel whose upper left corner is at (0, 0).
  Point2 operator()(Vec3d point) const;

 private:
  uint32_t across_ = kX, up_ = kY;
  Vec3d lower_, upper_;
  double scale_ = 1, margin_, width_, height_;
};

/// The least extent is a hundredth of the largest one or less.
bool is_flat(const Box3f& bounds);

/// Primitives as they are seen flat, up to a number that still shows something: triangles and parallelograms as
/// polygons, spheres as discs. `paint(number)` paints the primitive of that number over all geometries.
template <class F>
void add_primitives(Drawing& drawing, Point2 at, const FlatView& view, std::span<const Geometry> geometries, F&& paint);

/// The corners of a primitive as it is seen flat; none for one that is not valid.
std::vector<Point2> flat_outline(const FlatView& view, const Geometry& geometry, uint32_t primitive);

/// A box as it is seen flat.
void add_box(Drawing& drawing, Point2 at, const FlatView& view, const Box3f& box, const Paint& paint);

template <class F>
void add_primitives(Drawing& drawing, Point2 at, const FlatView& view, std::span<const Geometry> geometries,
                    F&& paint) {
  constexpr size_t kMost = 5000;
  size_t count = 0;
  for (const Geometry& geometry : geometries) count += primitive_count(geometry);
  if (count > kMost) return;
  uint32_t number = 0;
  for (const Geometry& geometry : geometries) {
    for (uint32_t i = 0; i < primitive_count(geometry); ++i, ++number) {
      std::vector<Point2> points = flat_outline(view, geometry, i);
      for (Point2& point : points) point = point + at;
      if (!points.empty()) drawing.shapes.emplace_back(DrawnPath{std::move(points), true, paint(number)});
    }
  }
}

}  // namespace kerf
