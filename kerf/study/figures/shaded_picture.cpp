#include "kerf/study/figures/shaded_picture.h"

#include <algorithm>
#include <cmath>

#include "kerf/render/frame.h"
#include "kerf/render/views.h"

namespace kerf {
namespace {

constexpr Vec3f kPaper{1, 1, 1}, kSurface{0.83F, 0.86F, 0.91F}, kWire{0.07F, 0.09F, 0.16F};

/// Where light comes from, as seen from the camera.
struct Lighting {
  Vec3f key, fill;

  explicit Lighting(const Camera& camera) {
    const Vec3d back = normalized(camera.eye - camera.look_at), right = normalized(cross(camera.up, back));
    const Vec3d up = cross(back, right);
    key = to_float(normalized(up * 0.8 - right * 0.5 + back * 0.6));
    fill = to_float(normalized(right * 0.8 + up * 0.2 + back * 0.5));
  }

  Vec3f shade(Vec3f normal, Vec3f direction) const {
    if (dot(normal, direction) > 0) normal = -normal;
    const float facing = -dot(normal, direction);
    const float light =
        0.42F + 0.30F * facing + 0.30F * std::max(dot(normal, key), 0.0F) + 0.12F * std::max(dot(normal, fill), 0.0F);
    return kSurface * std::min(light, 1.0F);
  }
};

/// The corners of a primitive with straight edges, and how far a hit lies from each edge, as a share of the height of
/// the primitive above it. No corners for a sphere.
struct Outline {
  Vec3d corners[4];
  double shares[4];
  uint32_t count = 0;

  Outline(const Geometry& geometry, const Hit& hit) {
    const double u = hit.u, v = hit.v;
    if (const auto* mesh = std::get_if<TriangleMesh>(&geometry.shapes)) {
      const Triangle t = mesh->triangle(hit.primitive);
      set({to_double(t.a), to_double(t.b), to_double(t.c)}, {v, 1 - u - v, u});
    } else if (const auto* shapes = std::get_if<Strided<Parallelogram>>(&geometry.shapes)) {
      const auto c = (*shapes)[hit.primitive].corners();
      set({c[0], c[1], c[2], c[3]}, {v, 1 - u, 1 - v, u});
    }
  }

 private:
  /// shares[i] belongs to the edge from corner i to the next.
  void set(std::initializer_list<Vec3d> points, std::initializer_list<double> weights) {
    count = static_cast<uint32_t>(points.size());
    std::copy(points.begin(), points.end(), corners);
    std::copy(weights.begin(), weights.end(), shares);
  }
};

/// How much of the wire's ink lies on a point of the picture: 1 on an edge.
double wire_at(const Projection& projection, const Geometry& geometry, const Hit& hit, Point2 pixel, double width) {
  constexpr double kSparse = 5;  // edges this many widths apart have full ink
  constexpr double kFaintest = 0.1;
  const Outline outline(geometry, hit);
  double ink = 0;
  for (uint32_t i = 0; i < outline.count; ++i) {
    const double distance =
        projection.distance_to_edge(pixel, outline.corners[i], outline.corners[(i + 1) % outline.count]);
    if (!(distance < width / 2)) continue;
    const double apart = distance / std::max(outline.shares[i], 1e-9);  // about the height above this edge, in pixels
    ink = std::max(ink, std::clamp(apart / (kSparse * width), kFaintest, 1.0));
  }
  return ink;
}

}  // namespace

Image shaded_picture(const Scene& scene, const Camera& camera, const ShadedOptions& options) {
  const CameraRays rays(camera, options.width, options.height);
  const Projection projection(camera, options.width, options.height);
  const Lighting lighting(camera);
  Image picture{options.width, options.height, 3, {}};
  picture.pixels.resize(size_t{options.width} * options.height * 3);
  const uint32_t n = std::max(options.samples, 1U);
  const auto sample = [&](Point2 at) {
    const Ray ray = rays(at.x, at.y);
    const Hit hit = scene.closest_hit(ray);
    if (!hit) return kPaper;
    const Vec3f shade = lighting.shade(scene.normal(hit), ray.direction);
    if (!(options.line_width > 0)) return shade;
    const double ink = 0.9 * wire_at(projection, scene.geometries()[hit.geometry], hit, at, options.line_width);
    return shade + (kWire - shade) * static_cast<float>(ink);
  };
  for_each_row(options.height, options.threads, options.progress, [&](uint32_t y) {
    for (uint32_t x = 0; x < options.width; ++x) {
      Vec3f sum;
      for (uint32_t i = 0; i < n * n; ++i) {
        const uint32_t column = i % n, row = i / n;
        sum = sum + sample({x + (column + 0.5) / n, y + (row + 0.5) / n});
      }
      for (uint32_t c = 0; c < 3; ++c) {
        picture.pixels[(size_t{y} * options.width + x) * 3 + c] = sum[c] / static_cast<float>(n * n);
      }
    }
  });
  return picture;
}

Image wireframe_picture(const Scene& scene, const Camera& camera, uint32_t width, uint32_t height, int threads) {
  return shaded_picture(scene, camera,
                        {.width = width, .height = height, .line_width = kWireWidth, .threads = threads});
}

Image distance_picture(const Scene& scene, const Camera& camera, const ShadedOptions& options) {
  ViewResult result =
      render_view(scene, camera, {View::depth, options.width, options.height, options.threads, options.progress});
  if (!result.complete) stop_figure();
  return std::move(result.values);
}

}  // namespace kerf
