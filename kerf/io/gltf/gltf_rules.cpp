#include "kerf/io/gltf/gltf_rules.h"

#include <algorithm>
#include <iterator>

namespace kerf {
namespace {

using enum GltfType;

// In the order of the alphabet. What is not read from a file has no row: it may be anything.
constexpr GltfRule kRules[] = {
    {"accessors", array},
    {"accessors[]", object},
    {"accessors[].bufferView", index},
    {"accessors[].byteOffset", size},
    {"accessors[].componentType", index},
    {"accessors[].count", size},
    {"accessors[].normalized", boolean},
    {"accessors[].sparse", object},
    {"accessors[].sparse.count", index},
    {"accessors[].sparse.indices", object},
    {"accessors[].sparse.indices.bufferView", index},
    {"accessors[].sparse.indices.byteOffset", index},
    {"accessors[].sparse.indices.componentType", index},
    {"accessors[].sparse.values", object},
    {"accessors[].sparse.values.bufferView", index},
    {"accessors[].sparse.values.byteOffset", index},
    {"accessors[].type", string},
    {"asset", object},
    {"asset.version", string},
    {"bufferViews", array},
    {"bufferViews[]", object},
    {"bufferViews[].buffer", index},
    {"bufferViews[].byteLength", size},
    {"bufferViews[].byteOffset", size},
    {"bufferViews[].byteStride", size},
    {"buffers", array},
    {"buffers[]", object},
    {"buffers[].byteLength", size},
    {"buffers[].uri", string},
    {"cameras", array},
    {"cameras[]", object},
    {"cameras[].perspective", object},
    {"cameras[].perspective.yfov", number},
    {"cameras[].type", string},
    {"extensionsRequired", array},
    {"extensionsRequired[]", string},
    {"extensionsUsed", array},
    {"extensionsUsed[]", string},
    {"images", array},
    {"images[]", object},
    {"images[].bufferView", index},
    {"images[].uri", string},
    {"materials", array},
    {"materials[]", object},
    {"materials[].alphaMode", string},
    {"materials[].emissiveFactor", array},
    {"materials[].emissiveFactor[]", number},
    {"materials[].emissiveTexture", object},
    {"materials[].emissiveTexture.index", index},
    {"materials[].name", string},
    {"materials[].pbrMetallicRoughness", object},
    {"materials[].pbrMetallicRoughness.baseColorFactor", array},
    {"materials[].pbrMetallicRoughness.baseColorFactor[]", number},
    {"materials[].pbrMetallicRoughness.baseColorTexture", object},
    {"materials[].pbrMetallicRoughness.baseColorTexture.index", index},
    {"materials[].pbrMetallicRoughness.baseColorTexture.texCoord", index},
    {"materials[].pbrMetallicRoughness.metallicFactor", number},
    {"materials[].pbrMetallicRoughness.metallicRoughnessTexture", object},
    {"materials[].pbrMetallicRoughness.metallicRoughnessTexture.index", index},
    {"materials[].pbrMetallicRoughness.roughnessFactor", number},
    {"meshes", array},
    {"meshes[]", object},
    {"meshes[].primitives", array},
    {"meshes[].primitives[]", object},
    {"meshes[].primitives[].attributes", object},
    {"meshes[].primitives[].indices", index},
    {"meshes[].primitives[].material", index},
    {"meshes[].primitives[].mode", index},
    {"nodes", array},
    {"nodes[]", object},
    {"nodes[].camera", index},
    {"nodes[].children", array},
    {"nodes[].children[]", index},
    {"nodes[].matrix", array},
    {"nodes[].matrix[]", number},
    {"nodes[].mesh", index},
    {"nodes[].rotation", array},
    {"nodes[].rotation[]", number},
    {"nodes[].scale", array},
    {"nodes[].scale[]", number},
    {"nodes[].skin", index},
    {"nodes[].translation", array},
    {"nodes[].translation[]", number},
    {"scene", index},
    {"scenes", array},
    {"scenes[]", object},
    {"scenes[].nodes", array},
    {"scenes[].nodes[]", index},
    {"textures", array},
    {"textures[]", object},
    {"textures[].sampler", index},
    {"textures[].source", index},
};
static_assert(std::size(kRules) == kGltfRuleCount);

constexpr bool before(const GltfRule& rule, std::string_view key) { return rule.key < key; }
static_assert(std::is_sorted(std::begin(kRules), std::end(kRules),
                             [](const GltfRule& a, const GltfRule& b) { return a.key < b.key; }));

// The attributes of a primitive have names of their own, and are numbers of accessors.
constexpr std::string_view kAttributes = "meshes[].primitives[].attributes.";
constexpr GltfRule kAttribute = {kAttributes, index};

// Extensions stand anywhere, and tinygltf passes over those that are no objects.
constexpr std::string_view kExtensions = "extensions";
constexpr GltfRule kExtension = {kExtensions, object};

bool is_extensions(std::string_view key) {
  return key == kExtensions || (key.ends_with(kExtensions) && key[key.size() - kExtensions.size() - 1] == '.');
}

bool is_extension(std::string_view key) {
  if (key.find("extras") != std::string_view::npos) return false;
  return is_extensions(key) || is_extensions(key.substr(0, std::min(key.rfind('.'), key.size())));
}

}  // namespace

const GltfRule* find_gltf_rule(std::string_view key) {
  const GltfRule* found = std::lower_bound(std::begin(kRules), std::end(kRules), key, before);
  if (found != std::end(kRules) && found->key == key) return found;
  if (key.starts_with(kAttributes)) return &kAttribute;
  return is_extension(key) ? &kExtension : nullptr;
}

size_t number_of(const GltfRule& rule) {
  return &rule == &kAttribute || &rule == &kExtension ? kGltfRuleCount : static_cast<size_t>(&rule - kRules);
}

std::string_view expectation(GltfType type) {
  switch (type) {
    case array:
      return "an array";
    case object:
      return "an object";
    case string:
      return "a string";
    case boolean:
      return "true or false";
    case number:
      return "a number";
    case index:
      return "an integer from 0 to 2147483647";
    case size:
      return "an integer of at least 0";
  }
  return {};
}

}  // namespace kerf
