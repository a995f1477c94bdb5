#include "kerf/study/figures/stroke_font.h"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

namespace kerf {
namespace {

// A font of lines. Each letter: how far to the next one, then its strokes. A stroke is a row of points, x then y, each
// a digit from 0 to z (35): the baseline is at y 4, small letters reach to e (14), capitals to i (18). It is a
// polyline, or after '~' a smooth curve from the first to the last point drawn towards those between, after '@' a
// closed one;
// '.' is a dot.
constexpr const char* kGlyphs[] = {
    "6",                                     // space
    "4 2i28 .24",                            // !
    "7 2i2e 5i5e",                           // "
    "c 5i34 9i74 2dbd 19a9",                 // #
    "c ~9f8i2i2baba43427 6k62",              // $
    "e @2d6d6i2i @84c4c989 bi34",            // %
    "d ~c43e3i8i8e2a2494ba",                 // &
    "4 2i2e",                                // '
    "7 ~5k2g2652",                           // (
    "7 ~2k5g5622",                           // )
    "a 5i5c 2h8d 8h2d",                      // *
    "c 6e66 2aaa",                           // +
    "5 3421",                                // ,
    "9 2a7a",                                // -
    "4 .24",                                 // .
    "9 227k",                                // /
    "c @24a4ai2i",                           // 0
    "c 3f6i64",                              // 1
    "c ~2e2iaiac24 24a4",                    // 2
    "c ~2f3iaiab5b ~5baba42427",             // 3
    "c 848i28b8",                            // 4
    "c 9i3i2b ~2b3dada43426",                // 5
    "c @24a4ac2c ~9h7i2i28",                 // 6
    "c 2iai54",                              // 7
    "c @3b9b9i3i @24a4ab2b",                 // 8
    "c @2aaaai2i ~3554a4ae",                 // 9
    "4 .2d .25",                             // :
    "5 .3d 3421",                            // ;
    "b 9f2a95",                              // <
    "c 2cac 28a8",                           // =
    "b 2f9a25",                              // >
    "b ~2f2i9i9c5c58 .54",                   // ?
    "g @68a8ad6d ~ada8e8ei2i24a4c5",         // @
    "c 146ib4 3999",                         // A
    "c 2i24 ~2i6i9i9b6b2b ~2b6baba46424",    // B
    "d ~bf9i2i2494b7",                       // C
    "d 2i24 ~2i5ibib45424",                  // D
    "b 9i2i2494 2b8b",                       // E
    "a 9i2i24 2b8b",                         // F
    "d ~bf9i2i24b4bb bb7b",                  // G
    "d 2i24 bib4 2bbb",                      // H
    "4 2i24",                                // I
    "a 8i88 ~88842428",                      // J
    "c 2i24 ai2a 5db4",                      // K
    "a 2i2494",                              // L
    "e 242i78cic4",                          // M
    "d 242ib4bi",                            // N
    "e @24c4ci2i",                           // O
    "c 2i24 ~2i6iaiaa6a2a",                  // P
    "e @24c4ci2i 88d3",                      // Q
    "c 2i24 ~2i6iaiaa6a2a 6aa4",             // R
    "c ~9f8i2i2baba43427",                   // S
    "c 1ibi 6i64",                           // T
    "d 2i29 ~2924b4b9 b9bi",                 // U
    "c 1i64bi",                              // V
    "i 1i549id4hi",                          // W
    "c 2ia4 ai24",                           // X
    "c 1i6bbi 6b64",                         // Y
    "c 2iai24a4",                            // Z
    "7 5k2k2252",                            // [
    "9 2k72",                                // backslash
    "7 2k5k5222",                            // ]
    "c 2d6iad",                              // ^
    "a 02a2",                                // _
    "7 2i5f",                                // `
    "b @24949e2e 9e94",                      // a
    "b 2i24 @24949e2e",                      // b
    "a ~9c8e2e248496",                       // c
    "b 9i94 @24949e2e",                      // d
    "b 2999 ~999e2e248496",                  // e
    "8 ~8i4i4e 4e44 2e7e",                   // f
    "b @24949e2e 9e93 ~93903021",            // g
    "b 2i24 ~2a2e9e9a 9a94",                 // h
    "4 2e24 .2i",                            // i
    "5 3e32 ~323010 .3i",                    // j
    "a 2i24 8e28 4a94",                      // k
    "5 2i27 ~272444",                        // l
    "g 2e24 ~2a2e8e8a 8a84 ~8a8eeeea eae4",  // m
    "b 2e24 ~2a2e9e9a 9a94",                 // n
    "c @24a4ae2e",                           // o
    "b 2e20 @24949e2e",                      // p
    "b 9e90 @24949e2e",                      // q
    "8 2e24 ~292e7e",                        // r
    "a ~8c7e2e2989843426",                   // s
    "8 4i47 ~474474 2e7e",                   // t
    "b 2e28 ~28249498 9e94",                 // u
    "a 1e549e",                              // v
    "e 1e447ea4de",                          // w
    "a 2e84 8e24",                           // x
    "a 1e54 9e30",                           // y
    "a 2e8e2484",                            // z
    "8 ~6k3k4b2b ~2b4b3262",                 // {
    "4 2k22",                                // |
    "8 ~2k5k4b6b ~6b4b5222",                 // }
    "c ~293d6a97ab",                         // ~
};
static_assert(std::size(kGlyphs) == 95, "one for each letter of ASCII that can be seen");
constexpr const char* kFrame = "a 24848i2i24";

constexpr double kBaseline = 4, kUnits = 20;  // of a letter's grid: capitals are 14 of 20 high

int digit(char c) { return c <= '9' ? c - '0' : c - 'a' + 10; }

/// The letters of a text as glyphs; what is no ASCII becomes one frame for each character.
std::vector<std::string_view> glyphs_of(std::string_view text) {
  std::vector<std::string_view> glyphs;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code >= ' ' && code <= '~') {
      glyphs.emplace_back(kGlyphs[code - ' ']);
    } else if (code < 0x80 || code >= 0xC0) {  // what continues a character of UTF-8 counts with its first byte
      glyphs.emplace_back(kFrame);
    }
  }
  return glyphs;
}

/// Appends the parabola from `a` to `c` drawn towards `b`, without `a`.
void append_parabola(std::vector<Point2>& points, Point2 a, Point2 b, Point2 c) {
  constexpr int kSteps = 8;
  for (int i = 1; i <= kSteps; ++i) {
    const double t = static_cast<double>(i) / kSteps, s = 1 - t;
    points.push_back(a * (s * s) + b * (2 * s * t) + c * (t * t));
  }
}

/// A uniform quadratic spline: parabolas between the middles of the sides of its control polygon.
std::vector<Point2> smooth(const std::vector<Point2>& control, bool is_closed) {
  const size_t n = control.size();
  const auto middle = [&](size_t i) { return (control[i % n] + control[(i + 1) % n]) * 0.5; };
  std::vector<Point2> points;
  if (is_closed) {
    points.push_back(middle(0));
    for (size_t i = 1; i <= n; ++i) append_parabola(points, points.back(), control[i % n], middle(i));
    return points;
  }
  points.push_back(control.front());
  for (size_t i = 1; i + 1 < n; ++i) {
    append_parabola(points, points.back(), control[i], i + 2 < n ? middle(i) : control.back());
  }
  return points;
}

/// One stroke of a glyph as the table writes it.
std::vector<Point2> stroke_points(std::string_view code, Point2 at, double unit) {
  const char kind = code.front();
  const bool is_marked = kind == '~' || kind == '@' || kind == '.';
  std::vector<Point2> points;
  for (size_t i = is_marked ? 1 : 0; i + 1 < code.size(); i += 2) {
    points.push_back({at.x + unit * digit(code[i]), at.y - unit * (digit(code[i + 1]) - kBaseline)});
  }
  return kind == '~' || kind == '@' ? smooth(points, kind == '@') : points;
}

}  // namespace

double text_width(std::string_view text, double size) {
  double width = 0;
  for (const std::string_view glyph : glyphs_of(text)) width += digit(glyph.front()) * size / kUnits;
  return width;
}

std::vector<std::vector<std::vector<Point2>>> text_strokes(std::string_view text, Point2 at, double size) {
  const double unit = size / kUnits;
  std::vector<std::vector<std::vector<Point2>>> letters;
  for (const std::string_view glyph : glyphs_of(text)) {
    std::vector<std::vector<Point2>> strokes;
    for (size_t begin = 2; begin < glyph.size();) {
      const size_t end = std::min(glyph.find(' ', begin), glyph.size());
      strokes.push_back(stroke_points(glyph.substr(begin, end - begin), at, unit));
      begin = end + 1;
    }
    letters.push_back(std::move(strokes));
    at.x += unit * digit(glyph.front());
  }
  return letters;
}

}  // namespace kerf
