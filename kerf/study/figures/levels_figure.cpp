#include "kerf/study/figures/levels_figure.h"

#include <fmt/format.h>

#include <algorithm>

#include "kerf/render/render_scene.h"
#include "kerf/study/figures/color_map.h"
#include "kerf/study/figures/flat_view.h"

namespace kerf {
namespace {

constexpr size_t kMostBoxes = 5000;  // of a panel: more would hide each other

constexpr size_t kMostColors = 64;  // of more primitives, colours say nothing

Vec3f owner_color(const TreeBox& box, size_t primitives) {
  if (!box.is_of_one()) return {0.42F, 0.42F, 0.45F};
  return category_color(primitives > kMostColors ? 0 : box.owner);
}

/// Panels of one size in lines and columns.
struct Grid {
  double panel_width, panel_height, text;
  double gap = 1.2 * text, margin = 1.2 * text, header = 2.2 * text, caption = 2.0 * text;

  double left(size_t column) const { return margin + static_cast<double>(column) * (panel_width + gap); }
  double top(size_t row) const {
    return margin + header + caption + static_cast<double>(row) * (panel_height + caption + gap);
  }
  double width(size_t columns) const { return left(columns) - gap + margin; }
  double height(size_t rows) const { return top(rows) - gap - caption + margin; }
};

void add_panel(Drawing& drawing, Point2 at, const FlatView& view, const Scene& scene, const std::vector<TreeBox>& boxes,
               const std::string& name, double text) {
  const size_t primitives = scene.report().primitives;
  drawing.group(name + "-primitives");
  add_primitives(drawing, at, view, scene.geometries(), [&](uint32_t number) {
    return Paint{Ink{category_color(primitives > kMostColors ? 0 : number), 0.85F}, std::nullopt, 0};
  });
  drawing.group(name);
  for (const TreeBox& box : largest_boxes(boxes, kMostBoxes)) {
    const Vec3f color = owner_color(box, primitives);
    add_box(drawing, at, view, box.bounds, {Ink{color, 0.13F}, Ink{color}, 0.11 * text});
  }
}

std::string column_title(uint32_t level) { return level == 0 ? "level 0 (root)" : fmt::format("level {}", level); }

void add_row(Drawing& drawing, const Grid& grid, size_t row, const Scene& scene, const FlatView& view,
             uint32_t levels) {
  const std::string& pipeline = scene.report().structure;
  const std::vector<TreeBox> tree = tree_boxes(scene);
  const double top = grid.top(row);
  const std::vector<TreeBox> input = input_boxes(scene, pipeline);
  drawing.group(fmt::format("row{}-caption", row));
  add_fitted_text(drawing, {grid.left(0), top - 0.6 * grid.text},
                  fmt::format("{}: {} boxes in{}, {} nodes, depth {}", pipeline, input.size(),
                              input.size() > kMostBoxes ? fmt::format(" (the {} largest shown)", kMostBoxes) : "",
                              tree.size(), scene.report().depth),
                  1.05 * grid.text, grid.width(levels + 1) - 2 * grid.margin);
  add_panel(drawing, {grid.left(0), top}, view, scene, input, fmt::format("row{}-input", row), grid.text);
  for (uint32_t level = 0; level < levels; ++level) {
    add_panel(drawing, {grid.left(level + 1), top}, view, scene, level_of(tree, level),
              fmt::format("row{}-level{}", row, level), grid.text);
  }
}

}  // namespace

SceneDescription crossing_triangles() {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0},           {8, 3.6F, 0.02F}, {7.6F, 4, 0.04F},
                   {0.4F, 4.5F, 0.02F}, {8, 0.5F, 0},     {8.4F, 0.9F, 0.04F}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  SceneDescription scene;
  scene.name = "two triangles";
  scene.materials.emplace_back();
  scene.objects.push_back({std::move(mesh), 0, true, "two triangles"});
  return scene;
}

std::vector<std::string> splitting_rows() {
  return {"refine(edge=5)+binned_sah(leaf=1)", "binned_sah(leaf=1)+late_split(sa_max=8)",
          "early_split(sa_max=8)+binned_sah(leaf=1)"};
}

Drawing levels_figure(const SceneDescription& scene, std::span<const std::string> rows, uint32_t levels,
                      const FigureOptions& options) {
  Drawing drawing;
  for (size_t row = 0; row < rows.size(); ++row) {
    const Scene built =
        build_scene(scene, {.structure = rows[row], .threads = options.threads, .skip_invalid = options.skip_invalid});
    const FlatView view(built.bounds(), options.width);
    const Grid grid{view.width(), view.height(), std::clamp(view.width() / 22, 9.0, 26.0)};
    if (row == 0) {
      drawing.width = grid.width(levels + 1);
      drawing.height = grid.height(rows.size());
      drawing.group("titles");
      const double y = grid.margin + grid.text;
      for (uint32_t column = 0; column <= levels; ++column) {
        const std::string title = column == 0 ? "input boxes" : column_title(column - 1);
        add_fitted_text(drawing, {grid.left(column) + grid.panel_width / 2, y}, title, 1.2 * grid.text,
                        grid.panel_width, Anchor::middle);
      }
    }
    add_row(drawing, grid, row, built, view, levels);
    if (options.progress && !options.progress(static_cast<double>(row + 1) / static_cast<double>(rows.size()))) {
      stop_figure();
    }
  }
  return drawing;
}

}  // namespace kerf
