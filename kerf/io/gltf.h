#pragma once

#include <string>

#include "kerf/io/model.h"

namespace kerf {

/// Reads a glTF 2.0 file, .gltf with its buffers and images beside or inside, or .glb, with tinygltf.
///
/// The default scene's nodes are placed by their transforms; triangles, strips and fans with indices of every width or
/// none; normals and the first set of texture coordinates; base colour, metallic and roughness factors, emission,
/// alpha-less base colour textures, index of refraction and transmission; the first perspective camera. What cannot be
/// shown (skins, morph targets, punctual lights, other textures, points and lines) is said in `notes`.
///
/// Throws Error (file) with the path as place, and a sentence that names the part of the file that is wrong.
Model read_gltf(const std::string& path);

}  // namespace kerf
