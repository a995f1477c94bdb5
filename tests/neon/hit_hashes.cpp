// Prints trees and what fixed rays hit as hashes: to be the same on every processor and instruction set, of which
// KERF_ISA names one. Columns: scene, kind of ray, way to ask, structure, hits, hash. With --sets it prints the names
// of those that this machine has.

#include <bit>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kerf/base/instruction_set.h"
#include "kerf/scene/scene.h"
#include "tests/support/moving_things.h"
#include "tests/support/random.h"

namespace kerf::test {
namespace {

constexpr size_t kRays = 500;             // of each kind
constexpr uint32_t kMostOneByOne = 1000;  // things that brute force takes, which is slow where a processor is emulated

/// FNV-1a (Fowler, Noll, Vo).
class Hash {
 public:
  void add(uint32_t word) {
    for (int shift = 0; shift < 32; shift += 8) state_ = (state_ ^ (word >> shift & 0xFF)) * 0x100000001B3U;
  }
  void add(float number) { add(std::bit_cast<uint32_t>(number)); }
  void add(const Hit& hit) {
    hits_ += hit ? 1 : 0;
    for (const float number : {hit.t, hit.u, hit.v}) add(number);
    for (const uint32_t number : {hit.primitive, hit.geometry, hit.instance}) add(number);
  }
  void add_any(bool is_hit) {
    hits_ += is_hit ? 1 : 0;
    add(is_hit ? 1U : 0U);
  }
  uint64_t value() const { return state_; }
  size_t hits() const { return hits_; }

 private:
  size_t hits_ = 0;
  uint64_t state_ = 0xCBF29CE484222325U;
};

struct RayKind {
  std::string name;
  std::vector<Ray> rays;
};

Ray turned(const MovingThings& things, float size, Random& random) {
  const Vec3f target = things.vertices[random.below(static_cast<uint32_t>(things.vertices.size()))];
  const Vec3f origin = size * random.vector();
  const Vec3f way = target - origin;
  const float longest = largest(abs(way));
  return {.origin = origin, .direction = longest >= 0x1p-120F ? way * (1 / longest) : random.vector()};
}

/// Rays of some kinds through things that are `size` across.
std::vector<RayKind> ray_kinds(const MovingThings& things, float size) {
  Random random(5);
  std::vector<RayKind> kinds{{"any", {}}, {"at corners", {}}, {"along axes", {}}, {"between limits", {}}};
  for (size_t i = 0; i < kRays; ++i) {
    kinds[0].rays.push_back({.origin = size * random.vector(), .direction = random.vector()});
    kinds[1].rays.push_back(turned(things, size, random));
    Ray along = turned(things, size, random);
    const uint32_t axis = random.below(3);
    along.direction = {-0.0F, 0, -0.0F};
    along.direction[axis] = i % 2 == 0 ? -1.0F : 1.0F;
    for (uint32_t k = 0; k < 3; ++k) {  // on a line through a corner
      if (k != axis) along.origin[k] = things.vertices[random.below(static_cast<uint32_t>(things.vertices.size()))][k];
    }
    kinds[2].rays.push_back(along);
    Ray limited = turned(things, size, random);
    limited.t_min = -size * random.share();
    limited.t_max = size * random.share();
    kinds[3].rays.push_back(limited);
  }
  return kinds;
}

void print(const std::string& scene, const std::string& kind, const char* way, const std::string& structure,
           size_t hits, uint64_t hash) {
  std::printf("%s\t%s\t%s\t%s\t%zu\t%016" PRIx64 "\n", scene.c_str(), kind.c_str(), way, structure.c_str(), hits, hash);
}

void print_hits(const Scene& scene, const std::string& name, const RayKind& kind, const std::string& structure) {
  Hash single, any, batch, any_batch;
  for (const Ray& ray : kind.rays) {
    single.add(scene.closest_hit(ray));
    any.add_any(scene.any_hit(ray));
  }
  std::vector<Hit> hits(kind.rays.size());
  std::vector<uint8_t> any_hits(kind.rays.size());
  scene.closest_hit(kind.rays, hits, 1);
  scene.any_hit(kind.rays, any_hits, 1);
  for (const Hit& hit : hits) batch.add(hit);
  for (const uint8_t hit : any_hits) any_batch.add_any(hit != 0);
  print(name, kind.name, "closest", structure, single.hits(), single.value());
  print(name, kind.name, "closest", structure + ", batch", batch.hits(), batch.value());
  print(name, kind.name, "any", structure, any.hits(), any.value());
  print(name, kind.name, "any", structure + ", batch", any_batch.hits(), any_batch.value());
}

void print_scene(const std::string& name, uint32_t count, float size) {
  const MovingThings things = random_things(count, 3, size);
  const std::vector<RayKind> kinds = ray_kinds(things, size);
  for (const std::string structure :
       {"brute_force", "binned_sah", "binned_sah+packets", "binned_sah+bvh4", "binned_sah+bvh8",
        "early_split(budget=2)+binned_sah+bvh4", "binned_sah+quantised_bvh8", "spatial_split+quantised_bvh8",
        "spatial_split+bvh8", "lbvh+bvh8", "balanced"}) {
    if (structure == "brute_force" && count > kMostOneByOne) continue;
    Scene scene;
    for (const Geometry& geometry : things.geometries()) scene.add(geometry);
    const BuildReport report = scene.build({.structure = structure});
    print(name, "-", "tree", structure, 0, report.tree_hash);
    for (const RayKind& kind : kinds) print_hits(scene, name, kind, structure);
  }
}

}  // namespace
}  // namespace kerf::test

int main(int count, char** arguments) {
  if (count > 1 && std::string_view(arguments[1]) == "--sets") {
    for (const std::string_view set : kerf::instruction_sets()) {
      std::printf("%.*s\n", static_cast<int>(set.size()), set.data());
    }
    return 0;
  }
  for (const char* size : {"1e-40", "1e-30", "1e-12", "1", "1e11", "1e30"}) {
    kerf::test::print_scene(size, 150, std::strtof(size, nullptr));
  }
  kerf::test::print_scene("many", 3000, 10);
}
