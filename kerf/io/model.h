#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kerf/io/camera.h"
#include "kerf/io/material.h"
#include "kerf/io/mesh.h"

namespace kerf {

/// What a model file holds, all its parts in one mesh.
struct Model {
  Mesh mesh;                        ///< mesh.materials: numbers of `materials`
  std::vector<Material> materials;  ///< empty where the format or the file has none
  std::vector<Texture> textures;    ///< that the materials name
  std::optional<Camera> camera;     ///< the first one in the file, if it has any
  std::vector<std::string> notes;   ///< what of the file cannot be shown, a sentence each, without the file's name
};

/// Reads a model by the end of its name, in any case of letters: .ply, .obj, .stl, .gltf and .glb with readers of
/// their own, what else Assimp knows with that. Throws Error (file) as they do, and for an unknown end with the nearest
/// right word.
Model read_model(const std::string& path);

/// The ends of names that read_model() of this build knows, such as ".ply", in order.
std::vector<std::string> model_extensions();

}  // namespace kerf
