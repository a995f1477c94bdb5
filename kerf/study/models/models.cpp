#include "kerf/study/models/models.h"

#include <array>
#include <string>
#include <vector>

#include "kerf/base/error.h"
#include "kerf/base/nearest_word.h"

namespace kerf {
namespace {

constexpr uint64_t kMostTriangles = 0x7FFFFFFF;

constexpr std::array kModels = {
    ModelEntry{"city", "houses along streets, large walls with many small things on them", make_city},
    ModelEntry{"mirror", "the side mirror of a car as a CAD assembly; stands in for the paper's Mirror", make_mirror},
    ModelEntry{"needles", "long thin triangles in all directions", make_needles},
    ModelEntry{"plant", "pipes in all directions between floors and walls; stands in for the paper's Power Plant",
               make_plant},
    ModelEntry{"soup", "small triangles of all shapes without any order", make_soup},
    ModelEntry{"stadium", "a small, finely cut teapot in the middle of large coarse rows of seats", make_stadium},
};

const ModelEntry& find_model(std::string_view name) {
  std::vector<std::string_view> names;
  for (const ModelEntry& entry : kModels) {
    if (entry.name == name) return entry;
    names.push_back(entry.name);
  }
  throw Error(ErrorCode::invalid_option, "name", "unknown model '" + std::string(name) + "'" + suggestion(name, names));
}

}  // namespace

std::span<const ModelEntry> made_models() { return kModels; }

void check_model_name(std::string_view name) { find_model(name); }

MadeModel make_model(std::string_view name, uint64_t triangles, uint64_t seed) {
  if (triangles > kMostTriangles) {
    throw Error(ErrorCode::too_large, std::string(name), "a model has at most 2^31 - 1 triangles");
  }
  return find_model(name).make(triangles, seed);
}

}  // namespace kerf
