#pragma once

#include <span>
#include <string_view>

#include "kerf/base/transform.h"
#include "kerf/io/camera.h"
#include "kerf/io/scene_description.h"

namespace kerf {

/// The names of turns: "straight"; "x", "y", "z" (30 degrees about that axis); "xyz" (about x, then y, then z). Turned,
/// what was aligned with the axes is not any more, which is where splitting gains most.
std::span<const std::string_view> turn_names();

/// Throws Error (invalid_option) for another name.
Transform turn_by_name(std::string_view name);

Camera turned(const Camera& camera, const Transform& turn);
Mesh turned(Mesh mesh, const Transform& turn);
/// Every object and the camera; textures and materials stay as they are.
SceneDescription turned(SceneDescription scene, const Transform& turn);

/// Turns x into y, y into z and z into x; every coordinate keeps its bits.
Transform axes_exchanged();

/// Everything as many times as large, the camera too.
SceneDescription scaled(SceneDescription scene, double factor);

}  // namespace kerf
