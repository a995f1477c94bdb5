#include "kerf/study/figures/heat_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kerf/render/render_scene.h"
#include "kerf/render/views.h"
#include "kerf/study/figures/color_map.h"

namespace kerf {
namespace {

Image trace_view(const Scene& scene, const Camera& camera, View view, const FigureOptions& options,
                 const FigureProgress& progress, HeatRow& row) {
  ViewResult result = render_view(scene, camera, {view, options.width, options.height, options.threads, progress});
  if (!result.complete) stop_figure();
  const auto rays = static_cast<double>(result.rays);
  row.nodes_per_ray = static_cast<double>(result.counts.nodes) / rays;
  row.triangles_per_ray = static_cast<double>(result.counts.primitives) / rays;
  return std::move(result.values);
}

/// 1, 2 or 5 times a power of ten, so that at most six steps make `range`.
double tick_step(double range) {
  const double power = std::pow(10, std::floor(std::log10(range / 6)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (range / (factor * power) <= 6) return factor * power;
  }
  return 10 * power;
}

/// Sizes of a figure whose pictures are `width` wide.
struct Layout {
  double width, height;
  double text = std::clamp(width / 34, 9.0, 26.0);
  double margin = text, gap = text, bar = 1.4 * text, legend = 6.5 * text;
  double header = 2.4 * text, title = 2.2 * text;

  double left(size_t column) const { return margin + static_cast<double>(column) * (width + gap); }
};

Image colored(const Image& values, const HeatScale& scale) {
  Image picture{values.width, values.height, 3, {}};
  picture.pixels.reserve(values.pixels.size() * 3);
  for (const float value : values.pixels) {
    const Vec3f color = heat_color(scale.place(value));
    for (uint32_t c = 0; c < 3; ++c) picture.pixels.push_back(color[c]);
  }
  return picture;
}

/// The bar of colours with numbers beside it.
void add_legend(Drawing& drawing, Point2 at, const Layout& layout, const HeatScale& scale) {
  drawing.group("legend");
  const int steps = static_cast<int>(layout.height);
  for (int i = 0; i < steps; ++i) {
    const double top = at.y + layout.height * i / steps, share = 1 - (i + 0.5) / steps;
    // Down to the end, where the next ones cover it: no seams between them.
    drawing.rectangle({at.x, top}, {at.x + layout.bar, at.y + layout.height},
                      {Ink{heat_color(share)}, std::nullopt, 0});
  }
  const Ink ink{{0.2F, 0.2F, 0.2F}};
  const auto add_number = [&](double value, const std::string& text) {
    const double y = at.y + layout.height * (1 - scale.place(value)), x = at.x + layout.bar;
    drawing.line({x, y}, {x + 0.35 * layout.text, y}, ink, 0.07 * layout.text);
    drawing.text({x + 0.6 * layout.text, y + 0.33 * layout.text}, text, 0.95 * layout.text);
  };
  const double step = tick_step(scale.most - scale.least);
  const double room = 1.8 * layout.text / layout.height * (scale.most - scale.least);  // between two numbers
  for (double value = scale.least; value < scale.most - room; value += step) {
    add_number(value, fmt::format("{:.6g}", value));
  }
  add_number(scale.most, fmt::format("{}{:.6g}", scale.is_clipped ? ">= " : "", scale.most));
}

/// One line of pictures with its legend.
void add_pictures(Drawing& drawing, double top, const Layout& layout, std::span<const HeatRow> rows,
                  Image HeatRow::*image, double HeatRow::*mean, const char* what) {
  std::vector<const Image*> images;
  for (const HeatRow& row : rows) images.push_back(&(row.*image));
  const HeatScale scale = heat_scale(images);
  drawing.group(what);
  for (size_t i = 0; i < rows.size(); ++i) {
    const double x = layout.left(i);
    const float most = *std::max_element(images[i]->pixels.begin(), images[i]->pixels.end());
    const std::string caption = fmt::format("{:.1f} {} per ray, at most {:.0f}", rows[i].*mean, what, most);
    add_fitted_text(drawing, {x + layout.width / 2, top + layout.height + 1.4 * layout.text}, caption, layout.text,
                    layout.width, Anchor::middle);
    drawing.picture({x, top}, colored(*images[i], scale));
  }
  add_legend(drawing, {layout.left(rows.size()), top}, layout, scale);
}

}  // namespace

std::vector<HeatRow> trace_heat(const SceneDescription& scene, const Camera& camera, std::span<const std::string> rows,
                                const FigureOptions& options) {
  std::vector<HeatRow> result;
  for (size_t i = 0; i < rows.size(); ++i) {
    const Scene built =
        build_scene(scene, {.structure = rows[i], .threads = options.threads, .skip_invalid = options.skip_invalid});
    HeatRow row;
    row.row = built.report().structure;
    const size_t parts = 2 * rows.size();
    row.nodes = trace_view(built, camera, View::nodes, options, part_of(options.progress, 2 * i, parts), row);
    row.triangles =
        trace_view(built, camera, View::triangles, options, part_of(options.progress, 2 * i + 1, parts), row);
    result.push_back(std::move(row));
  }
  return result;
}

HeatScale heat_scale(std::span<const Image* const> images) {
  std::vector<float> all;
  for (const Image* image : images) all.insert(all.end(), image->pixels.begin(), image->pixels.end());
  HeatScale scale;
  if (all.empty()) return scale;
  constexpr double kShown = 0.998, kFar = 1.25;
  const auto nearly_all = all.begin() + static_cast<ptrdiff_t>(kShown * static_cast<double>(all.size() - 1));
  std::nth_element(all.begin(), nearly_all, all.end());
  const double most = *std::max_element(nearly_all, all.end());
  scale.is_clipped = *nearly_all > 0 && most > kFar * *nearly_all;
  scale.most = scale.is_clipped ? *nearly_all : most;
  if (!(scale.most > 0)) scale.most = 1;  // nothing was met
  return scale;
}

Drawing heat_figure(std::span<const HeatRow> rows) {
  Drawing drawing;
  if (rows.empty()) return drawing;
  const Layout layout{static_cast<double>(rows[0].nodes.width), static_cast<double>(rows[0].nodes.height)};
  const double upper = std::round(layout.margin + layout.header);
  const double lower = std::round(upper + layout.height + layout.title + layout.gap);
  drawing.width = layout.left(rows.size()) + layout.legend;
  drawing.height = lower + layout.height + layout.title + 0.3 * layout.margin;
  drawing.group("rows");
  for (size_t i = 0; i < rows.size(); ++i) {
    add_fitted_text(drawing, {layout.left(i) + layout.width / 2, layout.margin + 1.1 * layout.text}, rows[i].row,
                    1.2 * layout.text, layout.width, Anchor::middle);
  }
  add_pictures(drawing, upper, layout, rows, &HeatRow::nodes, &HeatRow::nodes_per_ray, "nodes");
  add_pictures(drawing, lower, layout, rows, &HeatRow::triangles, &HeatRow::triangles_per_ray, "triangles");
  return drawing;
}

}  // namespace kerf
