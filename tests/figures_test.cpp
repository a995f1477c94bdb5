// Figures: what their colours, boxes and lines say is checked against what they are drawn from.

#include <gtest/gtest.h>

#include <cmath>

#include "kerf/base/error.h"
#include "kerf/render/render_scene.h"
#include "kerf/study/figures/canvas.h"
#include "kerf/study/figures/color_map.h"
#include "kerf/study/figures/heat_figure.h"
#include "kerf/study/figures/leaves_figure.h"
#include "kerf/study/figures/levels_figure.h"
#include "kerf/study/figures/shaded_picture.h"
#include "kerf/study/figures/stroke_font.h"
#include "kerf/study/figures/svg.h"
#include "kerf/study/figures/tree_boxes.h"
#include "kerf/study/figures/visible_edges.h"

namespace kerf {
namespace {

float gray_at(const Image& image, uint32_t x, uint32_t y) {
  const float* p = &image.pixels[(size_t{y} * image.width + x) * 3];
  return (p[0] + p[1] + p[2]) / 3;
}

size_t count_of(const std::string& text, const std::string& word) {
  size_t count = 0;
  for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

/// The text of a group in SVG.
std::string group_of(const std::string& svg, const std::string& name) {
  const size_t begin = svg.find("<g id=\"" + name + "\">");
  return begin == std::string::npos ? "no such group" : svg.substr(begin, svg.find("</g>", begin) - begin);
}

/// One right triangle in the plane z = 0, which fills the lower left half of the view at z = 2.
SceneDescription one_triangle() {
  SceneDescription scene;
  scene.materials.emplace_back();
  scene.objects.push_back({Mesh{{{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}}, {{0, 1, 2}}}, 0, true, "triangle"});
  return scene;
}
Camera front_camera() { return {{0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 2 * std::atan(0.625) * 180 / 3.14159265358979}; }

TEST(HeatColor, BecomesLighterInEvenSteps) {
  constexpr int kSteps = 256;
  double shortest = 1, longest = 0;
  Vec3d before = oklab_of(heat_color(0));
  for (int i = 1; i <= kSteps; ++i) {
    const Vec3d now = oklab_of(heat_color(static_cast<double>(i) / kSteps)), step = now - before;
    EXPECT_GT(now.x, before.x) << i;
    shortest = std::min(shortest, std::sqrt(dot(step, step)));
    longest = std::max(longest, std::sqrt(dot(step, step)));
    before = now;
  }
  EXPECT_LT(longest, 1.2 * shortest) << "equal steps must look equally large";
  EXPECT_LT(oklab_of(heat_color(0)).x, 0.25);
  EXPECT_GT(oklab_of(heat_color(1)).x, 0.9);
  EXPECT_EQ(heat_color(-1), heat_color(0));
  EXPECT_EQ(heat_color(7), heat_color(1));
  EXPECT_EQ(heat_color(std::nan("")), heat_color(0));
}

TEST(HeatScale, EndsAtTheLargestValueOrAtAllButAFew) {
  const Image few{4, 1, 1, {0, 3, 17, 5}}, more{2, 1, 1, {21, 1}};
  const Image* both[] = {&few, &more};
  const HeatScale scale = heat_scale(both);
  EXPECT_EQ(scale.least, 0);
  EXPECT_EQ(scale.place(scale.most), 1);
  EXPECT_EQ(scale.most, 17) << "one pixel far above all others does not darken them";
  EXPECT_TRUE(scale.is_clipped);
  Image even{100, 10, 1, std::vector<float>(1000, 40)};
  even.pixels[7] = 41;
  const Image* one[] = {&even};
  EXPECT_EQ(heat_scale(one).most, 41);
  EXPECT_FALSE(heat_scale(one).is_clipped);
  const Image none{2, 1, 1, {0, 0}};
  const Image* nothing[] = {&none};
  EXPECT_GT(heat_scale(nothing).most, 0);
}

TEST(HeatFigure, PicturesAndLegendShareColoursAndNumbers) {
  HeatRow row{"binned_sah", {4, 1, 1, {0, 10, 20, 30}}, {4, 1, 1, {0, 0, 1, 2}}, 15, 0.75};
  const HeatRow rows[] = {row, row};
  const Drawing drawing = heat_figure(rows);
  size_t pictures = 0;
  bool has_least = false, has_most = false;
  for (const Shape& shape : drawing.shapes) {
    if (const auto* picture = std::get_if<DrawnPicture>(&shape)) {
      ++pictures;
      ASSERT_EQ(picture->image.pixels.size(), 12U);
      const float* last = &picture->image.pixels[9];
      EXPECT_EQ((Vec3f{last[0], last[1], last[2]}), heat_color(1));
      EXPECT_EQ(picture->image.pixels[0], heat_color(0).x);
    }
    if (const auto* text = std::get_if<DrawnText>(&shape)) {
      has_least |= text->text == "0";
      has_most |= text->text == "30";
    }
  }
  EXPECT_EQ(pictures, 4U);
  EXPECT_TRUE(has_least || has_most);
  EXPECT_TRUE(has_most) << "the upper end of the legend is the largest value";
  EXPECT_FALSE(drawing.is_vector());
  EXPECT_THROW(svg_text(drawing), Error);
}

TEST(HeatFigure, CountsAreThoseOfTheStructureForAnyThreads) {
  const SceneDescription scene = scattered_triangles();
  const Camera camera = framing_camera({{0, 0, 0}, {10, 6, 0}}, 1.5);
  const std::string rows[] = {"binned_sah(leaf=1)", "brute_force"};
  const auto one = trace_heat(scene, camera, rows, {.width = 48, .height = 32, .threads = 1});
  const auto many = trace_heat(scene, camera, rows, {.width = 48, .height = 32, .threads = 3});
  ASSERT_EQ(one.size(), 2U);
  EXPECT_EQ(one[1].triangles_per_ray, 20);
  EXPECT_LT(one[0].triangles_per_ray, 5);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(one[i].nodes.pixels, many[i].nodes.pixels);
    EXPECT_EQ(one[i].triangles.pixels, many[i].triangles.pixels);
  }
  FigureOptions stopped{.width = 48, .height = 32};
  stopped.progress = [](double) { return false; };
  EXPECT_THROW(trace_heat(scene, camera, rows, stopped), Error);
}

TEST(Wireframe, DrawsEdgesAndNothingInside) {
  const SceneDescription description = one_triangle();
  const Scene scene = build_scene(description);
  const Image picture = wireframe_picture(scene, front_camera(), 100, 100);  // 40 pixels a unit
  const float inside = gray_at(picture, 25, 70);
  EXPECT_GT(inside, 0.5F);
  EXPECT_LT(inside, 0.99F) << "not the paper";
  for (const auto& [x, y] : {std::pair{20U, 75U}, {30U, 60U}, {22U, 65U}}) {
    EXPECT_NEAR(gray_at(picture, x, y), inside, 0.02F) << "no line at " << x << ", " << y;
  }
  // Half of a line lies on the triangle: at the left border, the lower one and the diagonal.
  const auto darkest = [&](uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1) {
    float least = 1;
    for (uint32_t y = y0; y <= y1; ++y) {
      for (uint32_t x = x0; x <= x1; ++x) least = std::min(least, gray_at(picture, x, y));
    }
    return least;
  };
  EXPECT_LT(darkest(8, 60, 12, 60), 0.7F * inside);
  EXPECT_LT(darkest(30, 88, 30, 92), 0.7F * inside);
  EXPECT_LT(darkest(46, 50, 54, 50), 0.7F * inside);
  EXPECT_EQ(gray_at(picture, 80, 20), 1) << "beside it there is paper";
  EXPECT_EQ(picture.pixels, wireframe_picture(scene, front_camera(), 100, 100, 3).pixels);
}

TEST(Projection, IsTheInverseOfCameraRays) {
  const Camera camera{{3, 2, 5}, {0.5, 1, -1}, {0.1, 1, 0}, 50};
  const CameraRays rays(camera, 200, 120);
  const Projection projection(camera, 200, 120);
  for (const Point2 pixel : {Point2{0, 0}, Point2{150, 30}, Point2{99.5, 119}}) {
    const Ray ray = rays(pixel.x, pixel.y);
    const Point2 found = projection(to_double(ray.origin) + to_double(ray.direction) * 7.0);
    EXPECT_NEAR(found.x, pixel.x, 1e-4);
    EXPECT_NEAR(found.y, pixel.y, 1e-4);
  }
  const Vec3d a = to_double(rays(10, 50).direction) * 4.0 + camera.eye, behind = camera.eye * 2.0 - a;
  EXPECT_NEAR(projection.distance_to_edge({10, 50}, a, behind + Vec3d{1, 0, 0}), 0, 1e-3);
  EXPECT_NEAR(projection.distance_to_edge({10, 57}, a, to_double(rays(90, 50).direction) * 9.0 + camera.eye), 7, 1e-3);
}

TEST(LevelsFigure, ShowsTheBoxesOfEachLevel) {
  const std::string rows[] = {"binned_sah(leaf=1)", "early_split(sa_max=8)+binned_sah(leaf=1)"};
  const std::string svg = svg_text(levels_figure(crossing_triangles(), rows, 4, {}));
  const auto boxes = [&](const char* name) { return count_of(group_of(svg, name), "<rect"); };
  EXPECT_EQ(boxes("row0-input"), 2U);
  EXPECT_EQ(boxes("row0-level0"), 1U);
  EXPECT_EQ(boxes("row0-level1"), 2U);
  EXPECT_EQ(boxes("row1-input"), 8U) << "four pieces of each triangle";
  EXPECT_EQ(boxes("row1-level0"), 1U);
  EXPECT_EQ(boxes("row1-level1"), 2U);
  EXPECT_EQ(boxes("row1-level2"), 4U);
  EXPECT_EQ(boxes("row1-level3"), 8U);
  EXPECT_EQ(boxes("row2-input"), 0U);
}

TEST(TreeBoxes, KnowWhoseTheyAre) {
  const SceneDescription description = crossing_triangles();
  const Scene scene = build_scene(description, {.structure = "early_split(sa_max=8)+binned_sah(leaf=1)"});
  const auto boxes = tree_boxes(scene);
  ASSERT_EQ(boxes.size(), 15U);
  EXPECT_EQ(boxes[0].owner, TreeBox::kSeveral);
  size_t of_each[2] = {};
  for (const TreeBox& leaf : filled_leaves(boxes)) {
    ASSERT_TRUE(leaf.is_of_one());
    ++of_each[leaf.owner];
  }
  EXPECT_EQ(of_each[0], 4U);
  EXPECT_EQ(of_each[1], 4U);
  const auto two = largest_boxes(boxes, 2);
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(two[0].bounds, scene.bounds());
}

TEST(LeavesFigure, HasABoxForEachLeaf) {
  const std::string rows[] = {"binned_sah(leaf=1)", "early_split(budget=2)+sweep_sah"};
  const Drawing drawing = leaves_figure(scattered_triangles(), {}, rows, 100, {});
  ASSERT_TRUE(drawing.is_vector());
  const std::string svg = svg_text(drawing);
  EXPECT_EQ(count_of(group_of(svg, "row0-primitives"), "<path"), 20U);
  EXPECT_EQ(count_of(group_of(svg, "row0-leaves"), "<rect"), 20U);
  EXPECT_GT(count_of(group_of(svg, "row1-leaves"), "<rect"), 1U);
}

TEST(LeavesFigure, OfASolidSceneIsThatOfAnyThreads) {
  SceneDescription scene = one_triangle();
  std::get<Mesh>(scene.objects[0].shape).vertices.push_back({0, 0, -2});
  std::get<Mesh>(scene.objects[0].shape).triangles.push_back({0, 1, 3});
  const std::string rows[] = {"binned_sah(leaf=1)"};
  FigureOptions options{.width = 60, .height = 40, .threads = 1};
  const Image one = rasterized(leaves_figure(scene, front_camera(), rows, 1, options));
  options.threads = 3;
  EXPECT_EQ(one.pixels, rasterized(leaves_figure(scene, front_camera(), rows, 1, options)).pixels);
}

TEST(VisibleEdges, EndWhereSomethingIsInFront) {
  const Projection projection(front_camera(), 100, 100);
  const Box3f box{{-0.5F, -0.5F, -1}, {0.5F, 0.5F, -0.5F}};
  Image far{100, 100, 1, std::vector<float>(10000, HUGE_VALF)}, near{100, 100, 1, std::vector<float>(10000, 1.0F)};
  EXPECT_EQ(visible_edges(box, projection, far).size(), 12U);
  EXPECT_TRUE(visible_edges(box, projection, near).empty());
  for (size_t y = 0; y < 100; ++y) std::fill_n(near.pixels.begin() + static_cast<ptrdiff_t>(y) * 100, 50, HUGE_VALF);
  for (const auto& line : visible_edges(box, projection, near)) {
    for (const Point2& point : line) EXPECT_LE(point.x, 52);
  }
  const Box3f around{{-9, -9, -9}, {9, 9, 9}}, behind{{-1, -1, 3}, {1, 1, 4}};
  for (const auto& line : visible_edges(around, projection, far)) {
    for (const Point2& point : line) EXPECT_TRUE(point.x > -1 && point.x < 101 && point.y > -1 && point.y < 101);
  }
  EXPECT_TRUE(visible_edges(behind, projection, far).empty());
}

TEST(Canvas, CoversWhatIsDrawn) {
  Drawing drawing{10, 8, {}};
  drawing.rectangle({2, 2}, {6.5, 5}, {Ink{{0, 0, 0}}, std::nullopt, 0});
  const Image picture = rasterized(drawing);
  EXPECT_NEAR(gray_at(picture, 3, 3), 0, 1e-5);
  EXPECT_NEAR(gray_at(picture, 6, 3), 0.5, 1e-5) << "half of the pixel is covered";
  EXPECT_EQ(gray_at(picture, 7, 3), 1);
  EXPECT_EQ(gray_at(picture, 3, 5), 1);
  EXPECT_EQ(rasterized(drawing, 3).width, 30U);
  Drawing lines{20, 20, {}};
  lines.line({-1e9, 10.5}, {1e9, 10.5}, {{0, 0, 0}}, 2);
  lines.line({NAN, 0}, {1, 1}, {{0, 0, 0}}, 2);
  EXPECT_NEAR(gray_at(rasterized(lines), 4, 10), 0, 1e-5);
  EXPECT_EQ(gray_at(rasterized(lines), 4, 13), 1);
  EXPECT_THROW(rasterized(Drawing{}), Error);
}

TEST(Text, EveryLetterHasStrokesWithinItsWidth) {
  for (char c = '!'; c <= '~'; ++c) {
    const std::string letter(1, c);
    const auto letters = text_strokes(letter, {0, 0}, 20);
    ASSERT_EQ(letters.size(), 1U);
    EXPECT_FALSE(letters[0].empty()) << letter;
    for (const auto& stroke : letters[0]) {
      for (const Point2& p : stroke) {
        EXPECT_TRUE(p.x >= -0.5 && p.x <= text_width(letter, 20) + 0.5 && p.y >= -18 && p.y <= 6)
            << letter << ' ' << p.x << ' ' << p.y;
      }
    }
  }
  EXPECT_EQ(text_width("nn", 20), 2 * text_width("n", 20));
  EXPECT_EQ(text_strokes("\xC3\xA4", {0, 0}, 20).size(), 1U) << "one frame for one character";
  Drawing drawing;
  add_fitted_text(drawing, {0, 0}, std::string(200, 'm'), 20, 100);
  const auto& text = std::get<DrawnText>(drawing.shapes[0]);
  EXPECT_LE(text_width(text.text, text.size), 100);
  EXPECT_TRUE(text.text.ends_with("..."));
}

TEST(Svg, EscapesTextAndRefusesOtherEnds) {
  Drawing drawing{10, 10, {}};
  drawing.text({1, 1}, "a<b>&\"c\"", 5);
  EXPECT_NE(svg_text(drawing).find(">a&lt;b&gt;&amp;&quot;c&quot;</text>"), std::string::npos);
  EXPECT_TRUE(check_drawing_path("a.SVG"));
  EXPECT_FALSE(check_drawing_path("b.png"));
  EXPECT_THROW(check_drawing_path("c.gif"), Error);
}

}  // namespace
}  // namespace kerf
