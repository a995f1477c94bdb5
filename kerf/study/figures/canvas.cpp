#include "kerf/study/figures/canvas.h"

#include <algorithm>
#include <cmath>

#include "kerf/base/error.h"
#include "kerf/study/figures/stroke_font.h"

namespace kerf {
namespace {

/// Pixels [x0, x1) x [y0, y1) of a canvas.
struct PixelRange {
  uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  uint32_t width() const { return x1 - x0; }
};

uint32_t clamped(double x, uint32_t most) {
  return static_cast<uint32_t>(std::clamp(x, 0.0, static_cast<double>(most)));
}

/// The pixels within `margin` of some points; none if a point is not finite.
template <class Points>
PixelRange range_of(const Points& points, double margin, const Image& image) {
  double x0 = HUGE_VAL, y0 = HUGE_VAL, x1 = -HUGE_VAL, y1 = -HUGE_VAL;
  for (const Point2& p : points) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) return {};
    x0 = std::min(x0, p.x);
    x1 = std::max(x1, p.x);
    y0 = std::min(y0, p.y);
    y1 = std::max(y1, p.y);
  }
  if (!(x0 <= x1)) return {};
  return {clamped(std::floor(x0 - margin), image.width), clamped(std::floor(y0 - margin), image.height),
          clamped(std::ceil(x1 + margin), image.width), clamped(std::ceil(y1 + margin), image.height)};
}

/// Adds the part of each pixel of a row that lies in [from, to], times `weight`.
void add_span(std::vector<float>& row, double from, double to, float weight) {
  from = std::max(from, 0.0);
  to = std::min(to, static_cast<double>(row.size()));
  if (!(from < to)) return;
  const auto first = static_cast<size_t>(from);
  const size_t last = std::min(static_cast<size_t>(to), row.size() - 1);
  if (first == last) {
    row[first] += weight * static_cast<float>(to - from);
    return;
  }
  row[first] += weight * static_cast<float>(static_cast<double>(first + 1) - from);
  for (size_t x = first + 1; x < last; ++x) row[x] += weight;
  row[last] += weight * static_cast<float>(to - static_cast<double>(last));
}

/// Where a horizontal line crosses a polygon, in order.
void find_crossings(std::span<const Point2> polygon, double y, std::vector<double>& crossings) {
  crossings.clear();
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Point2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    if ((a.y <= y) != (b.y <= y)) crossings.push_back(a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y));
  }
  std::sort(crossings.begin(), crossings.end());
}

double distance_to_segment(Point2 p, Point2 a, Point2 b) {
  const Point2 along = b - a, to = p - a;
  const double squared = along.x * along.x + along.y * along.y;
  const double t = squared > 0 ? std::clamp((to.x * along.x + to.y * along.y) / squared, 0.0, 1.0) : 0;
  const Point2 rest = to - along * t;
  return std::sqrt(rest.x * rest.x + rest.y * rest.y);
}

/// Raises the mask to how far the line from a to b covers each pixel.
void cover_segment(std::vector<float>& mask, const PixelRange& range, Point2 a, Point2 b, double radius,
                   const Image& image) {
  const double reach = radius + 0.5;
  const Point2 both[] = {a, b};
  const PixelRange own = range_of(both, reach, image);
  for (uint32_t y = own.y0; y < own.y1; ++y) {
    double x0 = std::min(a.x, b.x), x1 = std::max(a.x, b.x);
    if (a.y != b.y) {  // the part of the line that is near this row
      const double slope = (b.x - a.x) / (b.y - a.y);
      const double top = std::clamp(y - reach, std::min(a.y, b.y), std::max(a.y, b.y));
      const double bottom = std::clamp(y + 1 + reach, std::min(a.y, b.y), std::max(a.y, b.y));
      const double at_top = a.x + slope * (top - a.y), at_bottom = a.x + slope * (bottom - a.y);
      x0 = std::max(x0, std::min(at_top, at_bottom));
      x1 = std::min(x1, std::max(at_top, at_bottom));
    }
    const uint32_t from = std::max(range.x0, clamped(std::floor(x0 - reach), image.width));
    const uint32_t to = std::min(range.x1, clamped(std::ceil(x1 + reach), image.width));
    for (uint32_t x = from; x < to; ++x) {
      const double distance = distance_to_segment({x + 0.5, y + 0.5}, a, b);
      // Lines thinner than a pixel are as wide as one, but fainter.
      const double wide = std::max(radius, 0.5);
      const auto part = static_cast<float>(std::clamp(wide + 0.5 - distance, 0.0, 1.0) * (radius / wide));
      float& covered = mask[size_t{y - range.y0} * range.width() + (x - range.x0)];
      covered = std::max(covered, part);
    }
  }
}

std::vector<Point2> scaled(const std::vector<Point2>& points, double scale) {
  std::vector<Point2> result;
  result.reserve(points.size() + 1);
  for (const Point2& point : points) result.push_back(point * scale);
  return result;
}

/// Draws shapes, enlarged.
struct Pen {
  Canvas& canvas;
  double scale;

  void draw(std::vector<Point2> points, bool is_closed, const Paint& paint) const {
    if (paint.fill && points.size() > 2) canvas.fill(points, *paint.fill);
    if (!paint.stroke || points.empty()) return;
    if (is_closed) points.push_back(points.front());
    canvas.stroke({&points, 1}, paint.width * scale, *paint.stroke);
  }
  void operator()(const DrawnRectangle& shape) const {
    const Point2 a = shape.lower, b = shape.upper;
    draw(scaled({a, {b.x, a.y}, b, {a.x, b.y}}, scale), true, shape.paint);
  }
  void operator()(const DrawnPath& shape) const { draw(scaled(shape.points, scale), shape.is_closed, shape.paint); }
  void operator()(const DrawnText& shape) const {
    const double size = shape.size * scale, width = text_width(shape.text, size);
    const double left = shape.anchor == Anchor::start ? 0 : shape.anchor == Anchor::middle ? width / 2 : width;
    for (const auto& letter : text_strokes(shape.text, shape.at * scale - Point2{left, 0}, size)) {
      canvas.stroke(letter, text_pen(size), shape.ink);
    }
  }
  void operator()(const DrawnPicture& shape) const { canvas.paste(shape.image, shape.at * scale, scale); }
  void operator()(const DrawnGroup&) const {}
};

uint32_t checked_size(double size) {
  if (size >= 1 && size <= 65536) return static_cast<uint32_t>(std::ceil(size));
  throw Error(ErrorCode::invalid_argument, "figure", "a picture must have from 1 to 65536 pixels each way");
}

}  // namespace

Canvas::Canvas(uint32_t width, uint32_t height, Vec3f background) : image_{width, height, 3, {}} {
  image_.pixels.resize(size_t{width} * height * 3);
  for (size_t i = 0; i < image_.pixels.size(); ++i) image_.pixels[i] = background[i % 3];
}

void Canvas::blend(uint32_t x, uint32_t y, const Ink& ink, float coverage) {
  const float share = std::clamp(coverage * ink.opacity, 0.0F, 1.0F);
  float* pixel = &image_.pixels[(size_t{y} * image_.width + x) * 3];
  for (uint32_t c = 0; c < 3; ++c) pixel[c] += share * (ink.color[c] - pixel[c]);
}

void Canvas::fill(std::span<const Point2> polygon, const Ink& ink) {
  constexpr int kLines = 16;  // of each row of pixels
  const PixelRange range = range_of(polygon, 0, image_);
  std::vector<float> row;
  std::vector<double> crossings;
  for (uint32_t y = range.y0; y < range.y1; ++y) {
    row.assign(range.width(), 0);
    for (int line = 0; line < kLines; ++line) {
      find_crossings(polygon, y + (line + 0.5) / kLines, crossings);
      for (size_t i = 0; i + 1 < crossings.size(); i += 2) {
        add_span(row, crossings[i] - range.x0, crossings[i + 1] - range.x0, 1.0F / kLines);
      }
    }
    for (uint32_t x = 0; x < range.width(); ++x) {
      if (row[x] > 0) blend(range.x0 + x, y, ink, row[x]);
    }
  }
}

void Canvas::stroke(std::span<const std::vector<Point2>> lines, double width, const Ink& ink) {
  std::vector<Point2> all;
  for (const auto& line : lines) all.insert(all.end(), line.begin(), line.end());
  const PixelRange range = range_of(all, width / 2 + 1, image_);
  std::vector<float> mask(size_t{range.width()} * (range.y1 - range.y0));
  if (mask.empty()) return;
  for (const auto& line : lines) {
    for (size_t i = 0; i < line.size(); ++i) {
      if (i + 1 < line.size() || line.size() == 1) {
        cover_segment(mask, range, line[i], line[std::min(i + 1, line.size() - 1)], width / 2, image_);
      }
    }
  }
  for (uint32_t y = range.y0; y < range.y1; ++y) {
    for (uint32_t x = range.x0; x < range.x1; ++x) {
      const float covered = mask[size_t{y - range.y0} * range.width() + (x - range.x0)];
      if (covered > 0) blend(x, y, ink, covered);
    }
  }
}

void Canvas::paste(const Image& image, Point2 at, double scale) {
  const Point2 corners[] = {at, at + Point2{image.width * scale, image.height * scale}};
  const PixelRange range = range_of(corners, 0, image_);
  for (uint32_t y = range.y0; y < range.y1; ++y) {
    const double row = std::floor((y + 0.5 - at.y) / scale);
    if (row < 0 || row >= image.height) continue;
    for (uint32_t x = range.x0; x < range.x1; ++x) {
      const double column = std::floor((x + 0.5 - at.x) / scale);
      if (column < 0 || column >= image.width) continue;
      const float* from =
          &image.pixels[(static_cast<size_t>(row) * image.width + static_cast<size_t>(column)) * image.channels];
      for (uint32_t c = 0; c < 3; ++c) {
        image_.pixels[(size_t{y} * image_.width + x) * 3 + c] = from[image.channels == 3 ? c : 0];
      }
    }
  }
}

Image rasterized(const Drawing& drawing, double scale) {
  Canvas canvas(checked_size(drawing.width * scale), checked_size(drawing.height * scale));
  for (const Shape& shape : drawing.shapes) std::visit(Pen{canvas, scale}, shape);
  return canvas.image();
}

}  // namespace kerf
