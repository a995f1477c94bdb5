#pragma once

#include <utility>

#include "kerf/io/scene_description.h"
#include "kerf/render/surface.h"
#include "kerf/scene/scene.h"

namespace kerf {

/// What finds the hits of a description, which must stay as it is: geometry number i is its object i, seen by camera
/// rays if it is visible. Throws Error (invalid_geometry) with the object's place for what a Scene refuses, else as
/// Scene::build().
Scene build_scene(const SceneDescription& description, const BuildOptions& options = {});

/// A described scene, built by build_scene().
class RenderScene {
 public:
  /// Takes the description over. Throws Error (invalid_argument) for a number of a material, texture, normal or texture
  /// coordinate that does not exist and for a material whose values are out of range, else as build_scene().
  explicit RenderScene(SceneDescription description, const BuildOptions& options = {});

  const SceneDescription& description() const { return description_; }
  const Scene& scene() const { return scene_; }
  /// Gives the description back; the scene is not to be used any more.
  SceneDescription take_description() { return std::move(description_); }

  const Material& material(uint32_t object, uint32_t primitive) const;
  /// The point that a ray of this scene hit, and its material.
  Surface surface(const Ray& ray, const Hit& hit) const;
  /// The radiance from where nothing is hit.
  Vec3f background(bool to_camera) const { return to_camera ? background_ : background_with_ambient_; }

 private:
  SceneDescription description_;
  Scene scene_;
  Vec3f background_, background_with_ambient_;
};

}  // namespace kerf
