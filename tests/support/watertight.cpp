#include "tests/support/watertight.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "kerf/base/parallel.h"
#include "kerf/scene/scene.h"
#include "tests/support/random.h"

namespace kerf::test {
namespace {

constexpr const char* kStructures[] = {"binned_sah", "early_split(budget=2)+binned_sah"};

/// A solid at one size and place.
struct Placing {
  Solid solid;
  double scale;
  Vec3d offset;
};

std::vector<Placing> placings(const std::vector<Solid>& solids) {
  const Vec3d far{1e6, -1e6, 1e6};
  std::vector<Placing> all;
  for (const Solid& solid : solids) {
    for (const double scale : {1e-3, 1.0, 1e3, 1e6}) all.push_back({solid, scale, {0, 0, 0}});
    // A float at 1e6 is right to 0.06, so only solids whose triangles are larger than that are still solids there.
    for (const double scale : {1e3, 1e6}) all.push_back({solid, scale, far});
  }
  all.push_back({icosphere(1), 10, far});
  all.push_back({cog(9), 10, far});
  return all;
}

/// Points inside a placed solid: those that it names, and some whose coordinates are those of vertices, so that they
/// lie on planes of boxes. Each is proved to be inside by the solid angle of the surface.
std::vector<Vec3f> origins_in(const PlacedSolid& solid) {
  std::vector<Vec3f> origins = solid.inner;
  Random random(1);
  const Vec3f center = solid.inner[0];
  for (uint32_t i = 0; i < 3; ++i) {
    // The vertex nearest to the centre along one axis, of a few: its plane cuts through the solid.
    Vec3f best = solid.vertices[0];
    for (int tries = 0; tries < 200; ++tries) {
      const Vec3f v = solid.vertices[random.below(static_cast<uint32_t>(solid.vertices.size()))];
      if (std::abs(v[i] - center[i]) < std::abs(best[i] - center[i])) best = v;
    }
    Vec3f on_plane = solid.inner[1];
    on_plane[i] = best[i];
    origins.push_back(on_plane);
  }
  std::erase_if(origins, [&](Vec3f p) { return std::abs(winding_number(solid, p) - 1) > 1e-6L; });
  return origins;
}

/// A direction of one of six kinds: at a vertex, at a point of an edge, at a point of a face, anywhere, along an axis,
/// in a plane of two axes.
Vec3f direction_from(Vec3f origin, const PlacedSolid& solid, Random& random) {
  const TriangleCorners t = solid.triangles[random.below(static_cast<uint32_t>(solid.triangles.size()))];
  const Vec3f a = solid.vertices[t[0]], b = solid.vertices[t[1]], c = solid.vertices[t[2]];
  const float share = random.share();
  switch (random.below(8)) {
    case 0:
    case 1:
      return a - origin;
    case 2:
      return a + share * (b - a) - origin;
    case 3:
      return (a + share * (b - a) - origin) * random.between(0.1F, 10);
    case 4:
      return a + share * (b - a) + random.share() * (1 - share) * (c - a) - origin;
    case 5:
      return random.vector();
    case 6: {
      Vec3f along;
      along[random.below(3)] = random.below(2) == 0 ? 1.0F : -1.0F;
      return along;
    }
    default: {
      Vec3f flat = random.below(2) == 0 ? random.vector() : a - origin;
      flat[random.below(3)] = random.below(2) == 0 ? 0.0F : -0.0F;
      return flat;
    }
  }
}

/// Rays by block, so that any number of threads makes the same.
std::vector<Ray> make_rays(const PlacedSolid& solid, std::span<const Vec3f> origins, size_t count, uint64_t seed) {
  std::vector<Ray> rays(count);
  parallel_for(count, 4096, [&](size_t begin, size_t end) {
    Random random(seed + begin);
    for (size_t i = begin; i < end; ++i) {
      do {
        const Vec3f origin = origins[random.below(static_cast<uint32_t>(origins.size()))];
        rays[i] = {.origin = origin, .direction = direction_from(origin, solid, random)};
      } while (rays[i].direction == Vec3f{});
    }
  });
  return rays;
}

/// Traces `count` rays from inside and names the first that gets out.
void expect_no_way_out(const Placing& placing, const std::string& structure, size_t count, uint64_t seed) {
  const PlacedSolid solid = place(placing.solid, placing.scale, placing.offset);
  const std::vector<Vec3f> origins = origins_in(solid);
  const std::string where = placing.solid.name + " x " + std::to_string(placing.scale) + " at " +
                            std::to_string(placing.offset.x) + ", " + structure;
  ASSERT_GE(origins.size(), 2U) << where;
  Scene scene;
  scene.add(solid.mesh());
  EXPECT_EQ(scene.build({.structure = structure}).degenerate, 0U) << where;
  const std::vector<Ray> rays = make_rays(solid, origins, count, seed);
  std::vector<Hit> hits(count);
  scene.closest_hit(rays, hits);
  size_t missed = 0, first = 0;
  for (size_t i = count; i-- > 0;) {
    if (!hits[i]) ++missed, first = i;
  }
  const Ray& ray = rays[first];
  EXPECT_EQ(missed, 0U) << where << ": ray " << first << std::hexfloat << " from " << ray.origin.x << ' '
                        << ray.origin.y << ' ' << ray.origin.z << " along " << ray.direction.x << ' ' << ray.direction.y
                        << ' ' << ray.direction.z;
}

}  // namespace

void expect_watertight(const std::vector<Solid>& solids, size_t rays) {
  const std::vector<Placing> all = placings(solids);
  const size_t count = rays / (all.size() * std::size(kStructures)) + 1;
  uint64_t seed = 1;
  for (const Placing& placing : all) {
    for (const char* structure : kStructures) expect_no_way_out(placing, structure, count, seed += 1U << 20);
  }
}

}  // namespace kerf::test
