#pragma once

#include <span>
#include <vector>

#include "kerf/io/image.h"
#include "kerf/study/figures/drawing.h"

namespace kerf {

/// Pixels to draw on, smoothed at all edges. What lies outside is cut off.
class Canvas {
 public:
  Canvas(uint32_t width, uint32_t height, Vec3f background = {1, 1, 1});

  /// The inside of a polygon by the even-odd rule.
  void fill(std::span<const Point2> polygon, const Ink& ink);
  /// Lines with round ends, as one shape: where they cross, ink is not laid twice. A line of one point is a dot.
  void stroke(std::span<const std::vector<Point2>> lines, double width, const Ink& ink);
  /// Pixels of 1 or 3 channels, each on `scale` x `scale` pixels of the canvas.
  void paste(const Image& image, Point2 at, double scale);

  const Image& image() const { return image_; }

 private:
  void blend(uint32_t x, uint32_t y, const Ink& ink, float coverage);

  Image image_;
};

/// The pixels of a drawing, `scale` of them for each of its own. Throws Error (invalid_argument) for a size outside
/// 1 to 65536.
Image rasterized(const Drawing& drawing, double scale = 1);

}  // namespace kerf
