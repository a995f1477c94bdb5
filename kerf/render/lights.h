#pragma once

#include <array>
#include <vector>

#include "kerf/render/render_scene.h"

namespace kerf {

/// A point on a light, drawn as seen from another point.
struct LightSample {
  SurfacePoint point;
  Vec3f direction;  ///< from the other point, of unit length
  Vec3f radiance;
  float density = 0;  ///< of the direction, over solid angle, the choice of the light included
};

/// Every primitive of a scene that emits. Half of the draws go by power, half to all alike, for the strongest light may
/// be far away or out of sight. Both sides of a surface emit.
class Lights {
 public:
  explicit Lights(const RenderScene& scene);

  size_t size() const { return lights_.size(); }

  /// Draws a point as seen from `from`: uniform over a triangle or rectangle, over the visible cap of a sphere. False
  /// if nothing can come from it.
  bool sample(Vec3d from, float choice, std::array<float, 2> u, LightSample& out) const;

  /// The density with which sample() draws the point of an object's primitive that is seen from `from` in the unit
  /// direction `direction`, `distance` away; 0 for what does not emit.
  float density(Vec3d from, Vec3f direction, double distance, const SurfacePoint& point, uint32_t object,
                uint32_t primitive) const;

 private:
  struct Light {
    uint32_t object, primitive;
    double area;
    float share = 0;  // the probability that it is drawn
  };

  uint32_t number_of(uint32_t object, uint32_t primitive) const;
  bool sample_surface(const Light& light, Vec3d from, std::array<float, 2> u, LightSample& out) const;

  const RenderScene& scene_;
  std::vector<Light> lights_;
  std::vector<double> share_to_;                    // the sum of the shares up to and with each light
  std::vector<uint32_t> first_;                     // of each object: its first light; kNone if it has none
  std::vector<std::vector<uint32_t>> of_triangle_;  // of meshes with lights: of each triangle, kNone if it is none
};

}  // namespace kerf
