// kerf_bench_refit: for models and ways to move them, what a refit says of the tree and what rays say: the growth of
// its cost since it was built, and the nodes and triangles that rays visit compared with a tree built anew. Rays go
// from random points of the moved surface in random directions.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "kerf/io/ply.h"
#include "kerf/scene/scene.h"
#include "kerf/study/turn.h"

namespace {

using kerf::Box3f;
using kerf::Mesh;
using kerf::Vec3d;
using kerf::Vec3f;

double draw(std::mt19937& random) { return static_cast<double>(random()) * 0x1p-32; }

Vec3d draw_direction(std::mt19937& random) {
  for (;;) {
    const Vec3d d{2 * draw(random) - 1, 2 * draw(random) - 1, 2 * draw(random) - 1};
    const double length2 = dot(d, d);
    if (length2 > 0.01 && length2 < 1) return d / std::sqrt(length2);
  }
}

struct Move {
  std::string name;
  std::function<Vec3d(Vec3d, size_t)>
      apply;  ///< to a vertex in the scene's box scaled to [-1, 1] along its longest side
};

std::vector<Move> moves() {
  const auto twist = [](double turn) {
    return [=](Vec3d p, size_t) {
      const double a = turn * p.y;
      return Vec3d{std::cos(a) * p.x - std::sin(a) * p.z, p.y, std::sin(a) * p.x + std::cos(a) * p.z};
    };
  };
  const auto wave = [](double height) {
    return [=](Vec3d p, size_t) { return p + Vec3d{0, height * std::sin(6 * p.x), height * std::sin(6 * p.y)}; };
  };
  const auto shake = [](double size) {
    return [=](Vec3d p, size_t i) {
      std::mt19937 random(static_cast<uint32_t>(i) * 2654435761U);
      return p + size * draw_direction(random);
    };
  };
  const auto turn = [](const char* name) {
    return [t = kerf::turn_by_name(name)](Vec3d p, size_t) { return t.point(p); };
  };
  return {{"none", [](Vec3d p, size_t) { return p; }},
          {"twist 0.25", twist(0.25)},
          {"twist 1", twist(1)},
          {"twist 4", twist(4)},
          {"wave 0.02", wave(0.02)},
          {"wave 0.1", wave(0.1)},
          {"wave 0.4", wave(0.4)},
          {"shake 0.001", shake(0.001)},
          {"shake 0.01", shake(0.01)},
          {"shake 0.1", shake(0.1)},
          {"turn y", turn("y")},
          {"turn xyz", turn("xyz")},
          {"half slides",
           [](Vec3d p, size_t) {
             return p.x > 0 ? p + Vec3d{0, 0, 0.7} : p;
           }},
          {"halves cross",
           [](Vec3d p, size_t) {
             return p.x > 0 ? p - Vec3d{0.8, 0, 0} : p;
           }},
          {"one flies off",
           [](Vec3d p, size_t i) {
             return i == 345 ? 20.0 * p + Vec3d{20, 20, 20} : p;
           }},
          {"burst", [](Vec3d p, size_t) { return p * (1 + 2 * std::sqrt(dot(p, p))); }}};
}

Mesh moved(const Mesh& rest, const Move& move) {
  Box3f box;
  for (const Vec3f p : rest.vertices) box.extend(p);
  const Vec3d middle = 0.5 * (kerf::to_double(box.lower) + kerf::to_double(box.upper));
  const double size = 0.5 * kerf::largest(box.extent());
  Mesh mesh = rest;
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    mesh.vertices[i] =
        kerf::to_float(middle + size * move.apply((kerf::to_double(rest.vertices[i]) - middle) / size, i));
  }
  return mesh;
}

double double_area(const Mesh& mesh, size_t i) {
  const auto [a, b, c] = mesh.triangles[i];
  const Vec3d origin = kerf::to_double(mesh.vertices[a]);
  const Vec3d normal = cross(kerf::to_double(mesh.vertices[b]) - origin, kerf::to_double(mesh.vertices[c]) - origin);
  return std::sqrt(dot(normal, normal));
}

std::vector<kerf::Ray> make_rays(const Mesh& mesh, size_t count) {
  std::vector<double> sum{0};
  for (size_t i = 0; i < mesh.triangles.size(); ++i) sum.push_back(sum.back() + double_area(mesh, i));
  std::mt19937 random(1);
  std::vector<kerf::Ray> rays;
  for (size_t k = 0; k < count; ++k) {
    const auto found = std::upper_bound(sum.begin() + 1, sum.end() - 1, draw(random) * sum.back());
    const auto [a, b, c] = mesh.triangles[static_cast<size_t>(found - sum.begin()) - 1];
    const Vec3d p = kerf::to_double(mesh.vertices[a]);
    double s = draw(random), t = draw(random);
    if (s + t > 1) s = 1 - s, t = 1 - t;
    const Vec3d at = p + s * (kerf::to_double(mesh.vertices[b]) - p) + t * (kerf::to_double(mesh.vertices[c]) - p);
    rays.push_back({.origin = kerf::to_float(at), .t_min = 1e-6F, .direction = kerf::to_float(draw_direction(random))});
  }
  return rays;
}

struct Work {
  double nodes, primitives;
};

Work trace(const kerf::Scene& scene, const std::vector<kerf::Ray>& rays, std::vector<kerf::Hit>& hits) {
  kerf::TraceCounts counts;
  hits.resize(rays.size());
  scene.closest_hit(rays, hits, counts);
  const auto n = static_cast<double>(rays.size());
  return {static_cast<double>(counts.nodes) / n, static_cast<double>(counts.primitives) / n};
}

void measure(const std::string& name, const Mesh& rest, const std::string& structure, size_t count) {
  kerf::Scene scene;
  scene.add(kerf::TriangleMesh{rest.vertices, rest.triangles});
  scene.build({.structure = structure, .refittable = true});
  for (const Move& move : moves()) {
    const Mesh mesh = moved(rest, move);
    const kerf::Geometry geometry{kerf::TriangleMesh{mesh.vertices, mesh.triangles}};
    std::array<double, 7> refits{};
    for (double& seconds : refits) seconds = scene.refit(std::span(&geometry, 1)).seconds;
    std::nth_element(refits.begin(), refits.begin() + 3, refits.end());
    kerf::Scene fresh;
    fresh.add(kerf::TriangleMesh{mesh.vertices, mesh.triangles});
    const double built = fresh.build({.structure = structure}).seconds.total;
    const std::vector<kerf::Ray> rays = make_rays(mesh, count);
    std::vector<kerf::Hit> worn_hits, fresh_hits;
    const Work worn = trace(scene, rays, worn_hits), anew = trace(fresh, rays, fresh_hits);
    if (worn_hits != fresh_hits) {
      std::printf("%s, %s, %s: hits differ\n", name.c_str(), structure.c_str(), move.name.c_str());
      std::exit(EXIT_FAILURE);
    }
    const kerf::RefitReport& r = scene.refit();
    std::printf("%-20s %-30s %-14s %6.2f %6.2f %6.2f %8.1f %8.1f\n", name.c_str(), structure.c_str(), move.name.c_str(),
                (worn.nodes + worn.primitives) / (anew.nodes + anew.primitives), r.growth,
                r.sah_cost / r.built_sah_cost, 1e3 * refits[refits.size() / 2], 1e3 * built);
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::printf("%-20s %-30s %-14s %6s %6s %6s %8s %8s\n", "scene", "structure", "move", "rays", "growth", "cost",
              "refit ms", "build ms");
  for (int i = 1; i < argc; ++i) {
    const std::string path = argv[i];
    const Mesh mesh = kerf::read_ply(path);
    const std::string name = path.substr(path.rfind('/') + 1);
    for (const char* structure : {"binned_sah", "early_split(auto)+binned_sah"}) measure(name, mesh, structure, 20000);
  }
}
