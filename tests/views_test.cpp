// Cameras, and golden pictures of every view, named after the view. KERF_UPDATE_GOLDEN=1 writes them anew: look at
// them.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "kerf/base/error.h"
#include "kerf/io/image_read.h"
#include "kerf/io/image_write.h"
#include "kerf/render/views.h"
#include "tests/support/random_scene.h"

namespace kerf {
namespace {

TEST(Camera, RaysAreOfUnitLengthThroughPixelCentres) {
  const CameraRays rays({.eye = {0, 0, 2}, .look_at = {0, 0, 0}, .up = {0, 1, 0}, .fov = 90}, 4, 2);
  const Ray ray = rays.center(0, 0);  // half of the height is 1 at distance 1, of the width 2
  EXPECT_NEAR(ray.direction.x / -ray.direction.z, -1.5, 1e-6);
  EXPECT_NEAR(ray.direction.y / -ray.direction.z, 0.5, 1e-6);
  EXPECT_NEAR(dot(ray.direction, ray.direction), 1, 1e-6);
  EXPECT_EQ(ray.t_min, 0);
}

TEST(Camera, RefusesWhatHasNoPicture) {
  EXPECT_THROW(CameraRays({.eye = {1, 1, 1}, .look_at = {1, 1, 1}}, 4, 4), Error);
  EXPECT_THROW(CameraRays({.up = {0, 0, 5}}, 4, 4), Error);
  EXPECT_THROW(CameraRays({.up = {0, 0, 0}}, 4, 4), Error);
  EXPECT_THROW(CameraRays({.fov = 0}, 4, 4), Error);
  EXPECT_THROW(CameraRays({.fov = 180}, 4, 4), Error);
  EXPECT_THROW(CameraRays({.fov = std::nan("")}, 4, 4), Error);
  EXPECT_THROW(CameraRays({.eye = {std::nan(""), 0, 0}}, 4, 4), Error);
  EXPECT_THROW(CameraRays({}, 0, 4), Error);
}

TEST(Camera, FramingSeesTheWholeBox) {
  const Box3f boxes[] = {{{0, 0, 0}, {1, 1, 1}}, {{-100, 0, 3}, {100, 1e-3F, 4}}, {{5, 5, 5}, {5, 5, 5}}, {}};
  for (const Box3f& box : boxes) {
    for (const double aspect : {0.2, 1.0, 4.0}) {
      for (const Vec3d up : {Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}) {
        const Camera camera = framing_camera(box, aspect, up);
        const Vec3d view = camera.look_at - camera.eye;
        const double distance = std::sqrt(dot(view, view));
        EXPECT_GT(distance, 0);
        if (box.is_empty()) continue;
        const double tangent = std::tan(camera.fov * 3.14159265358979 / 360);
        const Vec3d side = cross(view, up), above = cross(side, view);
        for (int corner = 0; corner < 8; ++corner) {
          const Vec3d p{(corner & 1) != 0 ? box.upper.x : box.lower.x, (corner & 2) != 0 ? box.upper.y : box.lower.y,
                        (corner & 4) != 0 ? box.upper.z : box.lower.z};
          const Vec3d to = p - camera.eye;
          const double along = dot(to, view) / distance;
          EXPECT_GT(along, 0);
          EXPECT_LE(std::abs(dot(to, side)) / std::sqrt(dot(side, side)) / along, tangent * aspect);
          EXPECT_LE(std::abs(dot(to, above)) / std::sqrt(dot(above, above)) / along, tangent);
        }
      }
    }
  }
}

class GoldenView : public testing::TestWithParam<size_t> {};

INSTANTIATE_TEST_SUITE_P(Views, GoldenView, testing::Range(size_t{0}, views().size()),
                         [](const auto& entry) { return std::string(views()[entry.param].name); });

TEST_P(GoldenView, LooksAsItDid) {
  const test::RandomTriangles triangles(300, 5, 0.5F);
  Scene scene;
  scene.add(triangles.geometry());
  scene.build({.structure = "early_split(budget=2)+binned_sah"});
  const ViewEntry& entry = views()[GetParam()];
  const Camera camera = framing_camera(scene.bounds(), 1.5);
  const Image values = render_view(scene, camera, {.view = entry.view, .width = 96, .height = 64}).values;
  const Image picture = displayed(entry.view, values);
  const std::string path = std::string(KERF_GOLDEN) + "/" + std::string(entry.name) + ".pfm";
  if (std::getenv("KERF_UPDATE_GOLDEN") != nullptr) write_pfm(path, picture);
  const Image golden = read_pfm(path);
  ASSERT_EQ(golden.pixels.size(), picture.pixels.size());
  size_t different = 0;
  for (size_t i = 0; i < golden.pixels.size(); ++i) {
    different += std::abs(golden.pixels[i] - picture.pixels[i]) > 2.0F / 255 ? 1 : 0;
  }
  EXPECT_LE(different, 3U) << "a pixel on an edge may fall to the other side where sine and tangent differ";
}

TEST(Views, StopWhereProgressSaysSo) {
  const test::RandomTriangles triangles(300);
  Scene scene;
  scene.add(triangles.geometry());
  scene.build();
  double last = 0;
  ViewOptions options{.view = View::depth, .width = 32, .height = 64, .threads = 1};
  options.progress = [&](double done) {
    EXPECT_GT(done, last);
    last = done;
    return done < 0.5;
  };
  const ViewResult result = render_view(scene, framing_camera(scene.bounds(), 0.5), options);
  EXPECT_FALSE(result.complete);
  EXPECT_EQ(result.rays, 32U * 32U);
  EXPECT_EQ(result.values.pixels.back(), std::numeric_limits<float>::infinity());
  options.progress = nullptr;
  EXPECT_TRUE(render_view(scene, framing_camera(scene.bounds(), 0.5), options).complete);
}

}  // namespace
}  // namespace kerf
