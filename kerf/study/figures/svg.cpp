#include "kerf/study/figures/svg.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <iterator>

#include "kerf/base/error.h"
#include "kerf/base/letter_case.h"
#include "kerf/io/image_write.h"
#include "kerf/io/output_file.h"
#include "kerf/study/figures/canvas.h"
#include "kerf/study/figures/stroke_font.h"

namespace kerf {
namespace {

/// A number to a hundredth of a pixel.
std::string number(double x) {
  const double rounded = std::round(x * 100) / 100;
  return fmt::format("{}", rounded == 0 ? 0 : rounded);
}

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
  }
  return result;
}

std::string color_text(Vec3f c) {
  const auto byte = [](float x) { return static_cast<int>(std::lround(std::fmin(std::fmax(x, 0.0F), 1.0F) * 255)); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(c.x), byte(c.y), byte(c.z));
}

/// ` fill="#..." fill-opacity="..."`, or the same of a stroke.
std::string ink_text(const char* what, const std::optional<Ink>& ink) {
  if (!ink) return fmt::format(" {}=\"none\"", what);
  std::string text = fmt::format(" {}=\"{}\"", what, color_text(ink->color));
  if (ink->opacity < 1) text += fmt::format(" {}-opacity=\"{}\"", what, number(ink->opacity));
  return text;
}

std::string paint_text(const Paint& paint) {
  std::string text = ink_text("fill", paint.fill);
  if (paint.stroke) text += ink_text("stroke", paint.stroke) + fmt::format(" stroke-width=\"{}\"", number(paint.width));
  return text;
}

struct Writer {
  std::string text;
  bool in_group = false;

  template <class... Values>
  void add(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(text), format, std::forward<Values>(values)...);
  }
  void operator()(const DrawnRectangle& shape) {
    add("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{}/>\n", number(shape.lower.x), number(shape.lower.y),
        number(shape.upper.x - shape.lower.x), number(shape.upper.y - shape.lower.y), paint_text(shape.paint));
  }
  void operator()(const DrawnPath& shape) {
    text += "<path d=\"";
    char command = 'M';
    for (const Point2& point : shape.points) {
      add("{}{} {}", command, number(point.x), number(point.y));
      command = 'L';
    }
    add("{}\"{}/>\n", shape.is_closed ? "Z" : "", paint_text(shape.paint));
  }
  void operator()(const DrawnText& shape) {
    const char* anchor = shape.anchor == Anchor::start ? "start" : shape.anchor == Anchor::middle ? "middle" : "end";
    // As long as our own letters make it, whatever the reader's are.
    add("<text x=\"{}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{}\" textLength=\"{}\" "
        "lengthAdjust=\"spacingAndGlyphs\"{}>{}</text>\n",
        number(shape.at.x), number(shape.at.y), number(shape.size), anchor, number(text_width(shape.text, shape.size)),
        ink_text("fill", shape.ink), escaped(shape.text));
  }
  void operator()(const DrawnPicture&) {
    throw Error(ErrorCode::invalid_argument, "figure", "it holds pictures of pixels; write it as .png");
  }
  void operator()(const DrawnGroup& shape) {
    end_group();
    add("<g id=\"{}\">\n", escaped(shape.name));
    in_group = true;
  }
  void end_group() {
    if (in_group) text += "</g>\n";
    in_group = false;
  }
};

}  // namespace

std::string svg_text(const Drawing& drawing) {
  Writer writer;
  writer.add(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"Helvetica, Arial, sans-serif\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
      number(drawing.width), number(drawing.height));
  for (const Shape& shape : drawing.shapes) std::visit(writer, shape);
  writer.end_group();
  return writer.text + "</svg>\n";
}

bool check_drawing_path(const std::string& path) {
  const std::string extension = lower_case(std::filesystem::path(path).extension().string());
  if (extension != ".png" && extension != ".svg") {
    throw Error(ErrorCode::file, path, "has an unknown format for a figure; .png and .svg can be written");
  }
  return extension == ".svg";
}

void write_drawing(const std::string& path, const Drawing& drawing, double scale) {
  if (!check_drawing_path(path)) return write_png(path, rasterized(drawing, scale));
  const std::string text = svg_text(drawing);
  OutputFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace kerf
