#include "kerf/study/figures/drawing.h"

#include <algorithm>
#include <utility>

#include "kerf/study/figures/stroke_font.h"

namespace kerf {
namespace {

struct Mover {
  Point2 by;

  void operator()(DrawnRectangle& shape) const {
    shape.lower = shape.lower + by;
    shape.upper = shape.upper + by;
  }
  void operator()(DrawnPath& shape) const {
    for (Point2& point : shape.points) point = point + by;
  }
  void operator()(DrawnText& shape) const { shape.at = shape.at + by; }
  void operator()(DrawnPicture& shape) const { shape.at = shape.at + by; }
  void operator()(DrawnGroup&) const {}
};

}  // namespace

void Drawing::place(Point2 at, Drawing other) {
  for (Shape& shape : other.shapes) {
    std::visit(Mover{at}, shape);
    shapes.push_back(std::move(shape));
  }
  width = std::max(width, at.x + other.width);
  height = std::max(height, at.y + other.height);
}

bool Drawing::is_vector() const {
  return std::none_of(shapes.begin(), shapes.end(),
                      [](const Shape& shape) { return std::holds_alternative<DrawnPicture>(shape); });
}

void add_fitted_text(Drawing& drawing, Point2 at, std::string_view text, double size, double width, Anchor anchor,
                     double least) {
  std::string shown(text);
  const double wanted = text_width(shown, size);
  if (wanted > width) size *= std::max(width / wanted, least);
  for (size_t length = shown.size(); length > 0 && text_width(shown, size) > width;) {
    shown = std::string(text.substr(0, --length)) + "...";
  }
  drawing.text(at, std::move(shown), size, anchor);
}

}  // namespace kerf
