#include "kerf/render/lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kerf/render/color.h"
#include "kerf/render/frame.h"

namespace kerf {
namespace {

constexpr double kPi = std::numbers::pi;

double area_of(const Triangle& t) {
  const Vec3d normal = cross(to_double(t.b) - to_double(t.a), to_double(t.c) - to_double(t.a));
  return std::sqrt(dot(normal, normal)) / 2;
}
double area_of(const Sphere& s) { return 4 * kPi * s.radius * s.radius; }
double area_of(const Parallelogram& p) {
  const Vec3d normal = cross(to_double(p.u), to_double(p.v));
  return std::sqrt(dot(normal, normal));
}

Triangle triangle_of(const Mesh& mesh, uint32_t number) {
  const Mesh::Corners k = mesh.triangles[number];
  return {cleaned(mesh.vertices[k[0]]), cleaned(mesh.vertices[k[1]]), cleaned(mesh.vertices[k[2]])};
}

/// A point of a triangle, uniform for a uniform point of the square, by its folding along the diagonal.
SurfacePoint uniform_point(const Triangle& triangle, std::array<float, 2> u) {
  const double root = std::sqrt(static_cast<double>(u[0]));
  return triangle_point(triangle, root * (1 - u[1]), root * u[1]);
}

SurfacePoint uniform_point(const Parallelogram& shape, std::array<float, 2> u) {
  return parallelogram_point(shape, u[0], u[1]);
}

/// Of a sphere seen from within, where every point of it is visible.
SurfacePoint uniform_point(const Sphere& sphere, std::array<float, 2> u) {
  const double z = 1 - 2.0 * u[0], r = std::sqrt(std::max(0.0, 1 - z * z)), angle = 2 * kPi * u[1];
  const Vec3d outward{r * std::cos(angle), r * std::sin(angle), z};
  return sphere_point(sphere, outward);
}

/// One minus the cosine of half the angle under which a sphere is seen from a distance beyond its radius; exact also
/// for small angles.
double cap_height(double radius, double distance2) {
  const double sine2 = radius * radius / distance2;
  return sine2 / (1 + std::sqrt(std::max(0.0, 1 - sine2)));
}

/// The point of a sphere's cap, as seen from outside, in a uniform direction.
SurfacePoint cap_point(const Sphere& sphere, Vec3d to_center, double distance2, std::array<float, 2> u) {
  const double radius = sphere.radius, distance = std::sqrt(distance2);
  const double height = cap_height(radius, distance2) * u[0], cosine = 1 - height;
  const double sine2 = height * (2 - height);
  // Along the direction to the near one of its crossings with the sphere, then the angle as seen from its centre.
  const double along = distance * cosine - std::sqrt(std::max(0.0, radius * radius - distance2 * sine2));
  const double inner = std::clamp((distance2 + radius * radius - along * along) / (2 * distance * radius), -1.0, 1.0);
  const double inner_sine = std::sqrt(1 - inner * inner), angle = 2 * kPi * u[1];
  const Frame frame(to_float(to_center / -distance));
  const Vec3d outward = to_double(frame.x) * (inner_sine * std::cos(angle)) +
                        to_double(frame.y) * (inner_sine * std::sin(angle)) + to_double(frame.z) * inner;
  return sphere_point(sphere, outward);
}

/// From density over area to density over solid angle.
float over_solid_angle(double area, double distance2, double cosine) {
  return static_cast<float>(distance2 / (area * std::abs(cosine)));
}

}  // namespace

Lights::Lights(const RenderScene& scene) : scene_(scene) {
  const auto& objects = scene.description().objects;
  first_.assign(objects.size(), kNone);
  of_triangle_.resize(objects.size());
  double all_power = 0;
  std::vector<double> power;  // of each light
  for (uint32_t object = 0; object < objects.size(); ++object) {
    const auto add = [&](uint32_t primitive, double area) {
      const Vec3f emission = scene.material(object, primitive).emission;
      const double own = static_cast<double>(luminance(emission)) * area;
      if (!(own > 0) || !std::isfinite(own)) return false;
      if (first_[object] == kNone) first_[object] = static_cast<uint32_t>(lights_.size());
      lights_.push_back({object, primitive, area});
      power.push_back(own);
      all_power += own;
      return true;
    };
    if (const auto* mesh = std::get_if<Mesh>(&objects[object].shape)) {
      const bool has_one = mesh->materials.empty();
      if (has_one && scene.material(object, 0).emission == Vec3f{}) continue;
      std::vector<uint32_t> numbers(mesh->triangles.size(), kNone);
      for (uint32_t i = 0; i < numbers.size(); ++i) {
        if (add(i, area_of(triangle_of(*mesh, i)))) numbers[i] = static_cast<uint32_t>(lights_.size() - 1);
      }
      if (first_[object] != kNone) of_triangle_[object] = std::move(numbers);
    } else if (const auto* sphere = std::get_if<Sphere>(&objects[object].shape)) {
      add(0, area_of(*sphere));
    } else {
      add(0, area_of(*std::get_if<Parallelogram>(&objects[object].shape)));
    }
  }
  double sum = 0;
  for (size_t i = 0; i < lights_.size(); ++i) {
    const double share = 0.5 * power[i] / all_power + 0.5 / static_cast<double>(lights_.size());
    lights_[i].share = static_cast<float>(share);
    share_to_.push_back(sum += share);
  }
}

uint32_t Lights::number_of(uint32_t object, uint32_t primitive) const {
  if (first_[object] == kNone) return kNone;
  return of_triangle_[object].empty() ? first_[object] : of_triangle_[object][primitive];
}

bool Lights::sample_surface(const Light& light, Vec3d from, std::array<float, 2> u, LightSample& out) const {
  const SceneObject& object = scene_.description().objects[light.object];
  if (const auto* sphere = std::get_if<Sphere>(&object.shape)) {
    const Vec3d to_center = to_double(sphere->center) - from;
    const double distance2 = dot(to_center, to_center), radius = sphere->radius;
    if (distance2 > radius * radius) {
      out.point = cap_point(*sphere, to_center, distance2, u);
      out.direction = to_float(normalized(out.point.position - from));
      out.density = static_cast<float>(1 / (2 * kPi * cap_height(radius, distance2)));
      return true;
    }
    out.point = uniform_point(*sphere, u);
  } else if (const auto* mesh = std::get_if<Mesh>(&object.shape)) {
    out.point = uniform_point(triangle_of(*mesh, light.primitive), u);
  } else {
    out.point = uniform_point(*std::get_if<Parallelogram>(&object.shape), u);
  }
  const Vec3d offset = out.point.position - from;
  const double distance2 = dot(offset, offset);
  if (!(distance2 > 0)) return false;
  const Vec3d direction = offset / std::sqrt(distance2);
  const double cosine = dot(direction, out.point.normal);
  if (cosine == 0) return false;
  out.direction = to_float(direction);
  out.density = over_solid_angle(light.area, distance2, cosine);
  return true;
}

bool Lights::sample(Vec3d from, float choice, std::array<float, 2> u, LightSample& out) const {
  if (lights_.empty()) return false;
  const auto found = std::upper_bound(share_to_.begin(), share_to_.end(), double{choice} * share_to_.back());
  const size_t number = std::min<size_t>(static_cast<size_t>(found - share_to_.begin()), lights_.size() - 1);
  const Light& light = lights_[number];
  if (!sample_surface(light, from, u, out)) return false;
  out.density *= light.share;
  out.radiance = scene_.material(light.object, light.primitive).emission;
  return out.density > 0 && std::isfinite(out.density);
}

float Lights::density(Vec3d from, Vec3f direction, double distance, const SurfacePoint& point, uint32_t object,
                      uint32_t primitive) const {
  const uint32_t number = number_of(object, primitive);
  if (number == kNone) return 0;
  const Light& light = lights_[number];
  if (const auto* sphere = std::get_if<Sphere>(&scene_.description().objects[object].shape)) {
    const Vec3d to_center = to_double(sphere->center) - from;
    const double distance2 = dot(to_center, to_center), radius = sphere->radius;
    if (distance2 > radius * radius) {
      return light.share * static_cast<float>(1 / (2 * kPi * cap_height(radius, distance2)));
    }
  }
  return light.share * over_solid_angle(light.area, distance * distance, dot(to_double(direction), point.normal));
}

}  // namespace kerf
