#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "kerf/io/camera.h"
#include "kerf/io/mesh.h"

namespace kerf {

/// A model out of a program, and a camera that shows what it is about.
struct MadeModel {
  Mesh mesh;
  Camera camera;
};

/// A model that can be made in any size. `make` comes within 5 % of the number of triangles, and where the model cannot
/// be that small gives its smallest; the same numbers give the same model.
struct ModelEntry {
  std::string_view name;
  std::string_view sentence;
  MadeModel (*make)(uint64_t triangles, uint64_t seed);
};

/// All models, in alphabetical order.
std::span<const ModelEntry> made_models();

/// Throws Error (invalid_option) with the nearest right word for a name that is not there.
void check_model_name(std::string_view name);

/// Makes a model by its name. Throws as check_model_name() does, and Error (too_large) for more than 2^31 - 1
/// triangles.
MadeModel make_model(std::string_view name, uint64_t triangles, uint64_t seed);

// One file each.
MadeModel make_city(uint64_t triangles, uint64_t seed);
MadeModel make_mirror(uint64_t triangles, uint64_t seed);
MadeModel make_needles(uint64_t triangles, uint64_t seed);
MadeModel make_plant(uint64_t triangles, uint64_t seed);
MadeModel make_soup(uint64_t triangles, uint64_t seed);
MadeModel make_stadium(uint64_t triangles, uint64_t seed);

}  // namespace kerf
