// A tower that twists: built once, then its vertices move in place each frame and the tree follows, until it says that
// it has become too bad and is built anew.

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "kerf/scene/scene.h"

namespace {

constexpr uint32_t kAround = 60, kLevels = 120, kFrames = 12;

/// The tower's vertices, `turn` radians twisted at its top.
void place(std::vector<kerf::Vec3f>& vertices, float turn) {
  for (uint32_t level = 0; level <= kLevels; ++level) {
    const float height = static_cast<float>(level) / kLevels;
    for (uint32_t i = 0; i < kAround; ++i) {
      // A square that turns as it goes up, with a wide brim at every tenth level.
      const float angle = 6.2831853F * static_cast<float>(i) / kAround + turn * height;
      const float radius = (level % 10 == 0 ? 1.5F : 1.0F) * (i % 15 == 0 ? 1.4F : 1.0F);
      vertices[size_t{level} * kAround + i] = {radius * std::cos(angle), 4 * height, radius * std::sin(angle)};
    }
  }
}

}  // namespace

int main() {
  std::vector<kerf::Vec3f> vertices(size_t{kLevels + 1} * kAround);
  std::vector<kerf::TriangleCorners> triangles;
  for (uint32_t level = 0; level < kLevels; ++level) {
    for (uint32_t i = 0; i < kAround; ++i) {
      const uint32_t a = level * kAround + i, b = level * kAround + (i + 1) % kAround;
      triangles.push_back({a, b, a + kAround});
      triangles.push_back({b, b + kAround, a + kAround});
    }
  }
  place(vertices, 0);
  kerf::Scene scene;
  scene.add(kerf::TriangleMesh{vertices, triangles});
  const kerf::BuildOptions options{.structure = "early_split(auto)+binned_sah", .refittable = true};
  scene.build(options);

  const kerf::Ray ray{.origin = {0, 2.2F, 9}, .direction = {0, 0, -1}};
  uint32_t rebuilds = 0, hits = 0;
  for (uint32_t frame = 1; frame <= kFrames; ++frame) {
    place(vertices, static_cast<float>(frame));
    const kerf::RefitReport report = scene.refit();
    if (report.should_rebuild) {
      scene.build(options);
      ++rebuilds;
    }
    const kerf::Hit hit = scene.closest_hit(ray);
    hits += hit ? 1 : 0;
    std::printf("frame %2u: triangle %5u at t = %.4f, growth %.2f%s\n", frame, hit.primitive, hit.t, report.growth,
                report.should_rebuild ? ", built anew" : "");
  }
  std::printf("%u frames, %u hits, %u rebuilds\n", kFrames, hits, rebuilds);
}
