#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "kerf/base/vec3.h"
#include "kerf/geometry/shapes.h"
#include "kerf/io/camera.h"
#include "kerf/io/material.h"
#include "kerf/io/mesh.h"

namespace kerf {

/// What is seen where nothing is hit.
struct Background {
  Vec3f color{0.5F, 0.7F, 1.0F};
  float intensity = 1;   ///< multiplied with the colour
  float ambient = 0.1F;  ///< a grey radiance that is added for all but camera rays
};

/// One thing in a scene, in world coordinates.
struct SceneObject {
  std::variant<Mesh, Sphere, Parallelogram> shape;
  uint32_t material = 0;  ///< into SceneDescription::materials; a mesh with materials of its own has those
  bool visible = true;    ///< to camera rays; all others see it anyway
  std::string place;      ///< where it is from, for errors: "room.yaml:12:5" or a model's path
};

/// A scene as a file describes it: plain data, nothing built.
struct SceneDescription {
  std::string name, description;
  std::optional<Camera> camera;  ///< none: the objects are to be framed
  Background background;
  std::string structure;        ///< the pipeline that the file asks for; empty: none
  std::string structure_place;  ///< where it does
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<SceneObject> objects;
  bool is_lit = true;              ///< false for a bare model: light and sky are to be added
  std::vector<std::string> notes;  ///< what the file says that has no effect, a sentence each, with its place
};

/// Reads a YAML scene (.yaml, .yml) or a bare model (see read_model()), which must have a face. Throws Error (file).
SceneDescription read_scene(const std::string& path);

}  // namespace kerf
