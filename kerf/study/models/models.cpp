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
    ModelEntry{"plant", "pipes in all directions between floors and walls; stands in for the paper's Power Plant",
               make_plant},
};

}  // namespace

std::span<const ModelEntry> made_models() { return kModels; }

MadeModel make_model(std::string_view name, uint64_t triangles, uint64_t seed) {
  if (triangles > kMostTriangles) {
    throw Error(ErrorCode::too_large, std::string(name), "a model has at most 2^31 - 1 triangles");
  }
  std::vector<std::string_view> names;
  for (const ModelEntry& entry : kModels) {
    if (entry.name == name) return entry.make(triangles, seed);
    names.push_back(entry.name);
  }
  throw Error(ErrorCode::invalid_option, "model",
              "unknown model '" + std::string(name) + "'" + suggestion(name, names));
}

}  // namespace kerf
