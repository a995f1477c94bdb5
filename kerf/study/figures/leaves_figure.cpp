#include "kerf/study/figures/leaves_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kerf/render/bare_model.h"
#include "kerf/render/render_scene.h"
#include "kerf/study/figures/color_map.h"
#include "kerf/study/figures/flat_view.h"
#include "kerf/study/figures/seen_leaves.h"
#include "kerf/study/figures/shaded_picture.h"
#include "kerf/study/figures/visible_edges.h"

namespace kerf {
namespace {

constexpr Vec3f kBoxColor{0.05F, 0.32F, 0.70F}, kShapeColor{0.62F, 0.64F, 0.67F}, kEdgeColor{0.85F, 0.20F, 0.05F};

/// Pictures side by side with a line of text below each.
struct Strip {
  double picture_width, picture_height;
  double text = std::clamp(picture_width / 30, 9.0, 26.0);
  double margin = text, gap = 1.2 * text;

  Point2 corner(size_t column) const { return {margin + static_cast<double>(column) * (picture_width + gap), margin}; }
  void caption(Drawing& drawing, size_t column, const std::string& first, const std::string& second) const {
    const double x = corner(column).x + picture_width / 2, y = margin + picture_height;
    add_fitted_text(drawing, {x, y + 1.6 * text}, first, 1.1 * text, picture_width, Anchor::middle);
    add_fitted_text(drawing, {x, y + 3.1 * text}, second, text, picture_width, Anchor::middle);
  }
  void set_size(Drawing& drawing, size_t columns) const {
    drawing.width = corner(columns).x - gap + margin;
    drawing.height = 2 * margin + picture_height + 3.1 * text;
  }
};

/// Boxes as they are in a plane: the sum of their areas over that of the plane's part that the scene takes.
double flat_cover(const FlatView& view, const std::vector<TreeBox>& leaves, const Box3f& bounds) {
  const auto area = [&](const Box3f& box) {
    const Point2 extent = view(to_double(box.upper)) - view(to_double(box.lower));
    return std::abs(extent.x * extent.y);
  };
  double sum = 0;
  for (const TreeBox& leaf : leaves) sum += area(leaf.bounds);
  return area(bounds) > 0 ? sum / area(bounds) : 0;
}

void add_flat_row(Drawing& drawing, size_t column, const Scene& scene, const FlatView& view, const Strip& strip) {
  const Point2 at = strip.corner(column);
  drawing.group(fmt::format("row{}-primitives", column));
  add_primitives(drawing, at, view, scene.geometries(), [](uint32_t) {
    return Paint{Ink{kShapeColor}, std::nullopt, 0};
  });
  const std::vector<TreeBox> boxes = tree_boxes(scene), leaves = filled_leaves(boxes);
  drawing.group(fmt::format("row{}-leaves", column));
  for (const TreeBox& box : boxes) {
    if (!box.is_leaf) continue;
    const bool is_empty = box.owner == TreeBox::kNobody;
    const Ink line{kBoxColor, is_empty ? 0.35F : 1};
    add_box(drawing, at, view, box.bounds,
            {is_empty ? std::nullopt : std::optional(Ink{kBoxColor, 0.14F}), line, 0.1 * strip.text});
  }
  drawing.group(fmt::format("row{}-caption", column));
  strip.caption(drawing, column, scene.report().structure,
                fmt::format("{} leaves that hold something, {:.2f} of the area in all", leaves.size(),
                            flat_cover(view, leaves, scene.bounds())));
}

/// What is seen of a scene, whatever its structure.
struct Backdrop {
  Image picture, distances;
};

void add_solid_row(Drawing& drawing, size_t column, const Scene& scene, const Camera& camera, const Backdrop& backdrop,
                   const Strip& strip, size_t points, const FigureOptions& options) {
  const Point2 at = strip.corner(column);
  drawing.picture(at, backdrop.picture);
  drawing.group(fmt::format("row{}-leaves", column));
  const std::vector<TreeBox> shown = seen_leaves(scene, camera, points, options);
  const Projection projection(camera, options.width, options.height);
  const Paint paint{std::nullopt, Ink{kEdgeColor, 0.8F}, std::max(0.055 * strip.text, 0.7)};
  for (const TreeBox& box : shown) {
    for (std::vector<Point2>& line : visible_edges(box.bounds, projection, backdrop.distances)) {
      for (Point2& point : line) point = point + at;
      drawing.shapes.emplace_back(DrawnPath{std::move(line), false, paint});
    }
  }
  drawing.group(fmt::format("row{}-caption", column));
  strip.caption(drawing, column, scene.report().structure,
                fmt::format("{} of {} leaves, seen through {} points", shown.size(), scene.report().leaves, points));
}

}  // namespace

SceneDescription scattered_triangles() {
  // Centre, radius and turn of each: chosen by hand to have large and small ones, some of them close together.
  struct Place {
    double x, y, radius, turn;
  };
  constexpr Place kPlaces[] = {{1.2, 1.0, 0.9, 0.3}, {3.0, 0.8, 0.5, 1.1},  {4.4, 1.3, 0.8, 2.0}, {6.0, 0.7, 0.4, 0.2},
                               {7.6, 1.2, 1.0, 0.9}, {9.2, 0.9, 0.6, 1.6},  {0.8, 2.9, 0.5, 1.9}, {2.3, 2.6, 0.9, 0.7},
                               {3.9, 3.0, 0.5, 0.1}, {5.6, 2.7, 1.1, 1.3},  {7.2, 3.1, 0.4, 0.5}, {8.7, 2.8, 0.8, 1.8},
                               {1.4, 4.6, 0.8, 1.2}, {3.1, 4.7, 0.6, 0.4},  {4.7, 4.9, 0.5, 1.7}, {6.2, 4.5, 0.6, 0.8},
                               {7.6, 4.8, 0.9, 0.0}, {9.3, 4.5, 0.5, 1.45}, {5.2, 3.9, 0.3, 0.6}, {8.3, 3.8, 0.3, 1.0}};
  constexpr double kLength = 1.2;
  Mesh mesh;
  for (const Place& place : kPlaces) {
    const auto first = static_cast<uint32_t>(mesh.vertices.size());
    for (const double angle : {0.0, 2.9, 3.45}) {
      mesh.vertices.push_back(to_float(Vec3d{place.x + kLength * place.radius * std::cos(place.turn + angle),
                                             place.y + kLength * place.radius * std::sin(place.turn + angle), 0}));
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  SceneDescription scene;
  scene.name = "triangles in a plane";
  scene.materials.emplace_back();
  scene.objects.push_back({std::move(mesh), 0, true, "triangles in a plane"});
  return scene;
}

std::vector<std::string> leaf_rows() { return {"kd_sah", "binned_sah(leaf=1)"}; }

Drawing leaves_figure(const SceneDescription& scene, const Camera& camera, std::span<const std::string> rows,
                      size_t points, const FigureOptions& options) {
  const Box3f bounds = bounds_of(scene);
  const bool flat = is_flat(bounds);
  const FlatView view(bounds, options.width);
  const Strip strip = flat ? Strip{view.width(), view.height()}
                           : Strip{static_cast<double>(options.width), static_cast<double>(options.height)};
  Drawing drawing;
  strip.set_size(drawing, rows.size());
  Backdrop backdrop;
  for (size_t i = 0; i < rows.size(); ++i) {
    const Scene built =
        build_scene(scene, {.structure = rows[i], .threads = options.threads, .skip_invalid = options.skip_invalid});
    if (flat) {
      add_flat_row(drawing, i, built, view, strip);
      if (options.progress && !options.progress(static_cast<double>(i + 1) / static_cast<double>(rows.size()))) {
        stop_figure();
      }
      continue;
    }
    if (i == 0) {
      ShadedOptions shaded{.width = options.width, .height = options.height, .threads = options.threads};
      shaded.progress = options.progress;
      backdrop.picture = shaded_picture(built, camera, shaded);
      backdrop.distances = distance_picture(built, camera, shaded);
    }
    add_solid_row(drawing, i, built, camera, backdrop, strip, points, options);
  }
  return drawing;
}

}  // namespace kerf
