#pragma once

#include <string>

#include "kerf/io/model.h"

namespace kerf {

/// Reads a glTF 2.0 file, .gltf with its buffers and images beside or inside, or .glb, with tinygltf.
///
/// The nodes of the default scene are placed by their transforms, a mesh that several of them name is copied.
/// Triangles, strips and fans with indices of every width or none, sparse and quantized ones too; triangles that a
/// transform mirrors are turned, so that they stay counter-clockwise. Normals, and the texture coordinates that the
/// base colour is looked up with, transformed as KHR_texture_transform says. Base colour and its texture without alpha,
/// metal, roughness, emission and its strength, unlit surfaces; transmission and blending become glass. The mean of a
/// texture of roughness, metal, emission or transmission is multiplied with its factor. The first perspective camera.
///
/// What cannot be shown is said in `notes`: skins, morph targets, animations, lights, other textures, points and lines,
/// and an image that is missing or cannot be decoded, which is left out.
///
/// Throws Error (file) with the path as place, and a sentence that names the part of the file that is wrong: an
/// accessor that reaches beyond its buffer, an index out of range, nodes in a circle, a value of the wrong type, a
/// buffer that is missing, an extension that is required and not known. Error (too_large) for more than 2^31 - 1
/// triangles, copies counted. Memory stays in proportion to the file and the mesh; buffers are not copied.
Model read_gltf(const std::string& path);

}  // namespace kerf
