#pragma once

#include <map>
#include <optional>
#include <vector>

#include "kerf/io/gltf/gltf_accessor.h"
#include "kerf/io/gltf/gltf_material.h"
#include "kerf/io/gltf/gltf_scene.h"
#include "kerf/io/mesh_builder.h"

namespace kerf {

/// Copies the meshes of a file to where its nodes put them.
class GltfMeshes {
 public:
  GltfMeshes(GltfFile& file, GltfMaterials& materials) : file_(file), materials_(materials) {}

  /// One mesh of all instances, in their order. Fails where an accessor, an index or a mode is wrong.
  Mesh copy(const std::vector<GltfInstance>& instances);

 private:
  /// A primitive whose accessors have been found.
  struct Primitive {
    std::string name;
    int mode = TINYGLTF_MODE_TRIANGLES;
    uint32_t material = 0;
    int position_number = -1, normal_number = -1, uv_number = -1;  // of accessors: equal ones are copied once
    GltfAccessor positions;
    std::optional<GltfAccessor> normals, uvs, indices;
    GltfUvs lookup;

    size_t corner_count() const { return indices ? indices->count : positions.count; }
    size_t triangle_count() const;
  };
  using Primitives = std::vector<Primitive>;
  /// Where the copy of an accessor starts, for the instance at hand.
  using Copies = std::map<std::pair<int, int>, uint32_t>;

  const Primitives& find_mesh(int number);
  std::optional<Primitive> find_primitive(const tinygltf::Primitive& from, const std::string& name);
  void find_uvs(const tinygltf::Primitive& from, Primitive& primitive);
  void check_mode(const Primitive& primitive) const;
  std::optional<GltfAccessor> find_attribute(const tinygltf::Primitive& from, const std::string& attribute,
                                             uint32_t components, const std::string& user);
  MeshBuilder::Counts count(const Primitives& primitives) const;

  void copy_primitive(const Primitive& primitive);
  MeshBuilder::Part copy_attributes(const Primitive& primitive);
  std::vector<uint32_t> read_corners(const Primitive& primitive) const;

  GltfFile& file_;
  GltfMaterials& materials_;
  MeshBuilder builder_;
  std::map<int, Primitives> meshes_;
  Copies vertices_, normals_, uvs_;
};

}  // namespace kerf
