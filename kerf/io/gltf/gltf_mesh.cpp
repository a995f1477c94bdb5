#include "kerf/io/gltf/gltf_mesh.h"

#include <fmt/format.h>

namespace kerf {
namespace {

bool is_triangles(int mode) {
  return mode == TINYGLTF_MODE_TRIANGLES || mode == TINYGLTF_MODE_TRIANGLE_STRIP || mode == TINYGLTF_MODE_TRIANGLE_FAN;
}

/// Texture coordinates that were moved are no longer those of their accessor.
std::pair<int, int> uv_key(int accessor, const GltfUvs& lookup, uint32_t material) {
  return {accessor, lookup.is_identity ? -1 : static_cast<int>(material)};
}

}  // namespace

size_t GltfMeshes::Primitive::triangle_count() const {
  const size_t corners = corner_count();
  if (mode == TINYGLTF_MODE_TRIANGLES) return corners / 3;
  return corners < 3 ? 0 : corners - 2;
}

Mesh GltfMeshes::copy(const std::vector<GltfInstance>& instances) {
  MeshBuilder::Counts all;
  for (const GltfInstance& instance : instances) all += count(find_mesh(instance.mesh));
  builder_.reserve(all, file_.path);
  for (const GltfInstance& instance : instances) {
    builder_.set_place(instance.place);
    vertices_.clear(), normals_.clear(), uvs_.clear();
    for (const Primitive& primitive : find_mesh(instance.mesh)) copy_primitive(primitive);
  }
  return builder_.finish();
}

const GltfMeshes::Primitives& GltfMeshes::find_mesh(int number) {
  const auto [found, is_new] = meshes_.try_emplace(number);
  if (!is_new) return found->second;
  const tinygltf::Mesh& mesh = file_.json.meshes[static_cast<size_t>(number)];
  for (size_t i = 0; i < mesh.primitives.size(); ++i) {
    const std::string name = fmt::format("meshes[{}].primitives[{}]", number, i);
    if (std::optional<Primitive> primitive = find_primitive(mesh.primitives[i], name)) {
      found->second.push_back(std::move(*primitive));
    }
  }
  return found->second;
}

std::optional<GltfMeshes::Primitive> GltfMeshes::find_primitive(const tinygltf::Primitive& from,
                                                                const std::string& name) {
  if (from.mode >= TINYGLTF_MODE_POINTS && from.mode < TINYGLTF_MODE_TRIANGLES) {
    file_.notes.add("points and lines are left out", name);
    return {};
  }
  if (!is_triangles(from.mode)) file_.fail(fmt::format("{}.mode is {}; expected 0 to 6", name, from.mode));
  Primitive primitive;
  primitive.name = name;
  primitive.mode = from.mode;
  const std::optional<GltfAccessor> positions = find_attribute(from, "POSITION", 3, name);
  if (!positions) {
    file_.notes.add("what has no POSITION is left out", name);
    return {};
  }
  primitive.positions = *positions;
  primitive.position_number = from.attributes.at("POSITION");
  primitive.normals = find_attribute(from, "NORMAL", 3, name);
  if (primitive.normals) primitive.normal_number = from.attributes.at("NORMAL");
  primitive.material = materials_.use(from.material, name);
  primitive.lookup = materials_.uvs(from.material);
  find_uvs(from, primitive);
  if (from.indices >= 0) {
    primitive.indices = find_accessor(file_, from.indices, name + ".indices");
    const GltfAccessor& indices = *primitive.indices;
    const bool is_unsigned = indices.type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                             indices.type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                             indices.type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    if (!is_unsigned || indices.components != 1 || indices.normalized) {
      file_.fail(fmt::format("{}.indices must be single unsigned integers; accessors[{}] has {} of {} components", name,
                             from.indices, component_name(indices.type), indices.components));
    }
  }
  check_mode(primitive);
  if (!from.targets.empty()) file_.notes.add("morph targets have no effect", name);
  if (from.attributes.count("COLOR_0") > 0) file_.notes.add("colours of vertices have no effect", name);
  return primitive;
}

std::optional<GltfAccessor> GltfMeshes::find_attribute(const tinygltf::Primitive& from, const std::string& attribute,
                                                       uint32_t components, const std::string& user) {
  const auto found = from.attributes.find(attribute);
  if (found == from.attributes.end()) return {};
  const std::string name = fmt::format("{}.attributes.{}", user, attribute);
  const GltfAccessor accessor = find_accessor(file_, found->second, name);
  if (accessor.components != components || accessor.type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
    file_.fail(fmt::format("{} must have {} components, FLOAT or of at most 16 bits; accessors[{}] has {} of {}", name,
                           components, found->second, accessor.components, component_name(accessor.type)));
  }
  const auto positions = from.attributes.find("POSITION");
  if (positions == from.attributes.end()) return accessor;
  const size_t expected = file_.member(file_.json.accessors, positions->second, "accessors", user).count;
  if (accessor.count != expected) {
    file_.fail(fmt::format("{} has {} elements, and POSITION has {}", name, accessor.count, expected));
  }
  return accessor;
}

void GltfMeshes::find_uvs(const tinygltf::Primitive& from, Primitive& primitive) {
  const std::string attribute = fmt::format("TEXCOORD_{}", primitive.lookup.set);
  primitive.uvs = find_attribute(from, attribute, 2, primitive.name);
  if (primitive.uvs) primitive.uv_number = from.attributes.at(attribute);
}

void GltfMeshes::check_mode(const Primitive& primitive) const {
  const size_t corners = primitive.corner_count();
  const bool is_list = primitive.mode == TINYGLTF_MODE_TRIANGLES;
  if (is_list ? corners % 3 == 0 : corners == 0 || corners >= 3) return;
  file_.fail(fmt::format("{} has {} corners; expected {}", primitive.name, corners,
                         is_list ? "a multiple of 3" : "at least 3"));
}

MeshBuilder::Counts GltfMeshes::count(const Primitives& primitives) const {
  MeshBuilder::Counts counts;
  Copies vertices, normals, uvs;
  for (const Primitive& primitive : primitives) {
    MeshBuilder::Counts more;
    more.triangles = primitive.triangle_count();
    const size_t elements = primitive.positions.count;
    if (vertices.try_emplace({primitive.position_number, 0}).second) more.vertices = elements;
    if (primitive.normals && normals.try_emplace({primitive.normal_number, 0}).second) more.normals = elements;
    if (primitive.uvs && uvs.try_emplace(uv_key(primitive.uv_number, primitive.lookup, primitive.material)).second) {
      more.uvs = elements;
    }
    counts += more;
  }
  return counts;
}

MeshBuilder::Part GltfMeshes::copy_attributes(const Primitive& primitive) {
  MeshBuilder::Part part;
  part.material = primitive.material;
  const size_t elements = primitive.positions.count;
  const auto [vertices, vertices_new] = vertices_.try_emplace({primitive.position_number, 0});
  if (vertices_new) {
    const uint32_t first = vertices->second = builder_.add_vertices(elements);
    for_each_element(primitive.positions, [&](size_t i, const std::array<double, 4>& p) {
      builder_.set_vertex(first + i, {p[0], p[1], p[2]});
    });
  }
  part.vertices = vertices->second;
  if (primitive.normals) {
    const auto [normals, is_new] = normals_.try_emplace({primitive.normal_number, 0});
    if (is_new) {
      const uint32_t first = normals->second = builder_.add_normals(elements);
      for_each_element(*primitive.normals, [&](size_t i, const std::array<double, 4>& n) {
        builder_.set_normal(first + i, {n[0], n[1], n[2]});
      });
    }
    part.normals = normals->second;
  }
  if (!primitive.uvs) return part;
  const GltfUvs& lookup = primitive.lookup;
  const auto [uvs, is_new] = uvs_.try_emplace(uv_key(primitive.uv_number, lookup, primitive.material));
  part.uvs = uvs->second;
  if (!is_new) return part;
  const uint32_t first = part.uvs = uvs->second = builder_.add_uvs(elements);
  bool is_inside = true;
  for_each_element(*primitive.uvs, [&](size_t i, const std::array<double, 4>& uv) {
    double u = uv[0], v = uv[1];
    if (!lookup.is_identity) {
      u = lookup.u[0] * uv[0] + lookup.u[1] * uv[1] + lookup.u[2];
      v = lookup.v[0] * uv[0] + lookup.v[1] * uv[1] + lookup.v[2];
    }
    is_inside = is_inside && 0 <= u && u <= 1 && 0 <= v && v <= 1;
    builder_.set_uv(first + i, u, 1 - v);  // glTF counts from the top
  });
  if (!lookup.is_repeated && !is_inside) {
    file_.notes.add("a texture that is to be clamped or mirrored is repeated", primitive.name);
  }
  return part;
}

std::vector<uint32_t> GltfMeshes::read_corners(const Primitive& primitive) const {
  std::vector<uint32_t> corners(primitive.corner_count());
  const size_t vertex_count = primitive.positions.count;
  if (!primitive.indices) {
    for (size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<uint32_t>(i);
    return corners;
  }
  for_each_element(*primitive.indices,
                   [&](size_t i, const std::array<double, 4>& index) { corners[i] = static_cast<uint32_t>(index[0]); });
  for (size_t i = 0; i < corners.size(); ++i) {
    if (corners[i] >= vertex_count) {
      file_.fail(fmt::format("{}.indices has {} at {}; POSITION has {} elements", primitive.name, corners[i], i,
                             vertex_count));
    }
  }
  return corners;
}

void GltfMeshes::copy_primitive(const Primitive& primitive) {
  builder_.begin_part(copy_attributes(primitive));
  const std::vector<uint32_t> corner = read_corners(primitive);
  if (primitive.mode == TINYGLTF_MODE_TRIANGLES) {
    for (size_t i = 0; i + 2 < corner.size(); i += 3) builder_.add_triangle(corner[i], corner[i + 1], corner[i + 2]);
  } else if (primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
    for (size_t i = 0; i + 2 < corner.size(); ++i) {
      builder_.add_triangle(corner[i], corner[i + 1 + i % 2], corner[i + 2 - i % 2]);  // all wind alike
    }
  } else {
    for (size_t i = 0; i + 2 < corner.size(); ++i) builder_.add_triangle(corner[i + 1], corner[i + 2], corner[0]);
  }
}

}  // namespace kerf
