#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "kerf/base/vec3.h"
#include "kerf/io/image.h"

namespace kerf {

/// A point of a drawing: x to the right, y down, in pixels of its picture.
struct Point2 {
  double x = 0, y = 0;

  friend constexpr Point2 operator+(Point2 a, Point2 b) { return {a.x + b.x, a.y + b.y}; }
  friend constexpr Point2 operator-(Point2 a, Point2 b) { return {a.x - b.x, a.y - b.y}; }
  friend constexpr Point2 operator*(Point2 a, double s) { return {a.x * s, a.y * s}; }
  friend constexpr bool operator==(const Point2&, const Point2&) = default;
};

/// A colour as displayed, in [0, 1], and how much of it covers what is below.
struct Ink {
  Vec3f color;
  float opacity = 1;
};

/// What is inside and what is around it.
struct Paint {
  std::optional<Ink> fill;
  std::optional<Ink> stroke;
  double width = 1;  ///< of the stroke
};

struct DrawnRectangle {
  Point2 lower, upper;  ///< the upper left and the lower right corner
  Paint paint;
};
struct DrawnPath {
  std::vector<Point2> points;
  bool is_closed = false;
  Paint paint;
};
enum class Anchor { start, middle, end };
struct DrawnText {
  Point2 at;  ///< on the baseline
  std::string text;
  double size = 12;
  Anchor anchor = Anchor::start;
  Ink ink;
};
struct DrawnPicture {
  Point2 at;    ///< its upper left corner
  Image image;  ///< as displayed, one pixel for one of the drawing
};
/// What follows, up to the next group, has this name.
struct DrawnGroup {
  std::string name;
};
using Shape = std::variant<DrawnRectangle, DrawnPath, DrawnText, DrawnPicture, DrawnGroup>;

/// A drawing as a list of shapes, later ones above earlier ones, on white: every figure is made once and then written
/// as pixels (rasterized()) or as vectors (svg_text()).
struct Drawing {
  double width = 0, height = 0;
  std::vector<Shape> shapes;

  void group(std::string name) { shapes.emplace_back(DrawnGroup{std::move(name)}); }
  void rectangle(Point2 lower, Point2 upper, const Paint& paint) {
    shapes.emplace_back(DrawnRectangle{lower, upper, paint});
  }
  void line(Point2 a, Point2 b, const Ink& ink, double pen) {
    shapes.emplace_back(DrawnPath{{a, b}, false, {std::nullopt, ink, pen}});
  }
  void text(Point2 at, std::string letters, double size, Anchor anchor = Anchor::start, const Ink& ink = {}) {
    shapes.emplace_back(DrawnText{at, std::move(letters), size, anchor, ink});
  }
  void picture(Point2 at, Image image) { shapes.emplace_back(DrawnPicture{at, std::move(image)}); }

  /// Adds all of another drawing's shapes with its upper left corner at `at`, and grows to hold it.
  void place(Point2 at, Drawing other);
  /// No pictures of pixels: it can be written as vectors.
  bool is_vector() const;
};

/// Adds text of at most `width`: made smaller where it is too long, down to `least` of its size, then cut with "...".
void add_fitted_text(Drawing& drawing, Point2 at, std::string_view text, double size, double width,
                     Anchor anchor = Anchor::start, double least = 0.6);

}  // namespace kerf
