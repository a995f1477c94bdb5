#include "kerf/study/figures/wireframe_figure.h"

#include <algorithm>

#include "kerf/render/render_scene.h"
#include "kerf/study/figures/shaded_picture.h"

namespace kerf {
namespace {

/// "1,667,578".
std::string with_commas(size_t number) {
  std::string text = std::to_string(number);
  for (size_t i = text.size(); i > 3; i -= 3) text.insert(i - 3, ",");
  return text;
}

}  // namespace

Drawing wireframe_figure(const SceneDescription& scene, const Camera& camera, const std::string& structure,
                         const std::string& name, const FigureOptions& options) {
  const Scene built =
      build_scene(scene, {.structure = structure, .threads = options.threads, .skip_invalid = options.skip_invalid});
  ShadedOptions shaded{.width = options.width, .height = options.height, .threads = options.threads};
  shaded.line_width = kWireWidth;
  shaded.progress = options.progress;
  Drawing drawing;
  drawing.width = options.width;
  drawing.height = options.height;
  drawing.picture({0, 0}, shaded_picture(built, camera, shaded));
  if (name.empty()) return drawing;
  const double text = std::clamp(drawing.width / 30, 9.0, 28.0);
  add_fitted_text(drawing, {drawing.width / 2, drawing.height + 1.5 * text},
                  name + ": " + with_commas(built.report().primitives) + " primitives", text, drawing.width,
                  Anchor::middle);
  drawing.height += 2.4 * text;
  return drawing;
}

}  // namespace kerf
