#include "kerf/study/hit_verdict.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

namespace kerf {
namespace {

using Real = long double;
using Vec3r = Vec3<Real>;

Vec3r extended(Vec3f p) { return {p.x, p.y, p.z}; }
Real length(Vec3r v) { return std::sqrt(dot(v, v)); }

/// One triangle against one ray by signed volumes, another method than the library's.
struct Exact {
  Real t = 0;
  Real margin = 0;  ///< distance between the ray and the nearest edge's line, negative outside
  Real scale = 0;   ///< distance of the farthest corner
};

Exact cross_exactly(const Mesh& mesh, uint32_t primitive, const Ray& ray) {
  const auto& k = mesh.triangles[primitive];
  const Vec3r o = extended(ray.origin), d = extended(ray.direction);
  const Vec3r a = extended(mesh.vertices[k[0]]) - o, b = extended(mesh.vertices[k[1]]) - o,
              c = extended(mesh.vertices[k[2]]) - o;
  const Vec3r normal = cross(b - a, c - a);
  const Real slope = dot(normal, d);
  Exact result;
  result.scale = std::max({length(a), length(b), length(c)});
  result.t = slope != 0 ? dot(normal, a) / slope : std::numeric_limits<Real>::infinity();
  const Real side = slope > 0 ? 1 : -1;
  const auto margin = [&](Vec3r p, Vec3r q) {
    const Real across = length(cross(d, q - p));
    return across > 0 ? side * dot(d, cross(p, q)) / across : -std::numeric_limits<Real>::infinity();
  };
  result.margin = slope != 0 ? std::min({margin(a, b), margin(b, c), margin(c, a)}) : -result.scale;
  return result;
}

/// What floats cannot tell apart: some ulps of the corners' distance.
constexpr Real kFloatRounding = 0x1p-19L;
/// What the library's doubles may not get wrong.
constexpr Real kDoubleRounding = 0x1p-42L;

bool nearly(Real a, Real b, Real relative) { return std::abs(a - b) <= relative * std::max(std::abs(a), std::abs(b)); }

/// Kerf says that the ray crosses this triangle at t.
bool is_right_about_hit(const Exact& exact, const Hit& hit) {
  return exact.margin >= -kDoubleRounding * exact.scale && nearly(hit.t, exact.t, 1e-6L);
}

/// The depth is right although the oracle's is far off.
Verdict judge_depth(const Mesh& mesh, const Ray& ray, const Hit& kerf) {
  const Exact exact = cross_exactly(mesh, kerf.primitive, ray);
  return is_right_about_hit(exact, kerf) ? Verdict::oracle_wrong : Verdict::unexplained;
}

/// `mesh`: of Kerf's hit; `other`: of the oracle's.
Verdict judge_between(const Mesh& mesh, const Mesh& other, const Ray& ray, const Hit& kerf, const Hit& oracle,
                      double& depth_difference) {
  depth_difference = 0;
  if (!kerf && !oracle) return Verdict::same;
  if (kerf && oracle) depth_difference = std::abs(double{kerf.t} - oracle.t) / std::abs(oracle.t);
  if (kerf && oracle && kerf.primitive == oracle.primitive && &mesh == &other) {
    return depth_difference <= 1e-5 ? Verdict::same : judge_depth(mesh, ray, kerf);
  }
  Exact ours, theirs;
  if (kerf) {
    ours = cross_exactly(mesh, kerf.primitive, ray);
    if (!is_right_about_hit(ours, kerf)) return Verdict::unexplained;
  }
  if (oracle) theirs = cross_exactly(other, oracle.primitive, ray);
  if (oracle && kerf && nearly(ours.t, theirs.t, 1e-6L)) {
    // The same distance: two surfaces in one place, or the edge between neighbours.
    const Real inside = std::min(ours.margin / ours.scale, theirs.margin / theirs.scale);
    if (std::abs(inside) <= kFloatRounding) return Verdict::edge_tie;
    return inside > 0 ? Verdict::coincident : Verdict::oracle_wrong;
  }
  const bool disputed_is_ours = kerf && (!oracle || ours.t < theirs.t);
  const Exact& disputed = disputed_is_ours ? ours : theirs;
  const bool is_edge = std::abs(disputed.margin) <= kFloatRounding * disputed.scale;
  if (disputed_is_ours) return is_edge ? Verdict::edge_tie : Verdict::oracle_wrong;
  // The oracle's hit is nearer, so Kerf must be right that the ray misses that triangle.
  if (theirs.t < ray.t_min || theirs.t > ray.t_max) return Verdict::oracle_wrong;  // as where a ray leaves a surface
  if (disputed.margin > kDoubleRounding * disputed.scale) return Verdict::unexplained;
  return is_edge ? Verdict::edge_tie : Verdict::oracle_wrong;
}

}  // namespace

const char* verdict_name(Verdict verdict) {
  constexpr const char* kNames[] = {"same", "edge tie", "coincident", "oracle wrong", "unexplained"};
  return kNames[static_cast<int>(verdict)];
}

Verdict judge(const Mesh& mesh, const Ray& ray, const Hit& kerf, const Hit& oracle, double& depth_difference) {
  return judge_between(mesh, mesh, ray, kerf, oracle, depth_difference);
}

std::optional<Verdict> judge(std::span<const SceneObject> objects, const Ray& ray, const Hit& kerf, const Hit& oracle) {
  if (!kerf && !oracle) return Verdict::same;
  const auto mesh_of = [&](const Hit& hit) { return hit ? std::get_if<Mesh>(&objects[hit.geometry].shape) : nullptr; };
  const Mesh *mesh = mesh_of(kerf), *other = mesh_of(oracle);
  if ((kerf && mesh == nullptr) || (oracle && other == nullptr)) {
    const bool is_same = kerf && oracle && kerf.primitive == oracle.primitive && kerf.geometry == oracle.geometry &&
                         nearly(kerf.t, oracle.t, 1e-5L);
    return is_same ? std::optional(Verdict::same) : std::nullopt;
  }
  double difference = 0;
  return judge_between(mesh != nullptr ? *mesh : *other, other != nullptr ? *other : *mesh, ray, kerf, oracle,
                       difference);
}

}  // namespace kerf
