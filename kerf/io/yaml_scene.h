#pragma once

#include <string>

#include "kerf/io/scene_description.h"

namespace kerf {

/// Reads a scene in YAML, with the keys of RayON's scene files and a few more; docs/scenes.md lists all of them and
/// their defaults. Models that it names are read too, relative to its folder.
///
/// Strict: an unknown or duplicate key, a merge key, a wrong type or range, a material that is not there is an Error
/// (file) with the place "PATH:LINE:COLUMN" and the nearest right word. Materials and shapes of RayON that Kerf does
/// not have yet are an Error that says so.
SceneDescription read_yaml_scene(const std::string& path);

/// The same for a text; `name` stands for it in errors, files are sought relative to `folder`.
SceneDescription parse_yaml_scene(const std::string& text, const std::string& name, const std::string& folder);

}  // namespace kerf
