#include "kerf/io/assimp_model.h"

#include <assimp/BaseImporter.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <filesystem>
#include <new>
#include <numbers>
#include <string_view>

#include "kerf/base/error.h"
#include "kerf/io/assimp/assimp_guard.h"
#include "kerf/io/assimp/assimp_material.h"
#include "kerf/io/mapped_file.h"
#include "kerf/io/mesh_builder.h"
#include "kerf/io/notes.h"

namespace kerf {
namespace {

Vec3d vector_of(const aiVector3D& v) { return {v.x, v.y, v.z}; }

Transform transform_of(const aiMatrix4x4& m) {
  return {{{m.a1, m.b1, m.c1}, {m.a2, m.b2, m.c2}, {m.a3, m.b3, m.c3}}, {m.a4, m.b4, m.c4}};
}

/// Makes a Model of what Assimp has read.
class Converter {
 public:
  Converter(const aiScene& scene, const std::string& path)
      : scene_(scene), path_(path), materials_(scene, path, notes_), converted_(scene.mNumMaterials) {}

  Model convert() {
    walk();
    MeshBuilder::Counts counts;
    for (const Instance& instance : instances_) counts += count(*instance.mesh);
    builder_.reserve(counts, path_);
    for (const Instance& instance : instances_) copy(instance);
    if (scene_.mNumAnimations > 0) notes_.add("animations have no effect");
    if (scene_.mNumLights > 0) notes_.add("lights of the file have no effect");
    Model model;
    model.mesh = builder_.finish();
    for (const std::optional<AssimpMaterial>& converted : converted_) {
      model.materials.push_back(converted ? converted->material : Material{});
    }
    if (model.materials.empty()) model.mesh.materials.clear();
    model.textures = materials_.take_textures();
    model.camera = camera_;
    model.notes = notes_.sentences();
    return model;
  }

 private:
  struct Instance {
    const aiMesh* mesh;
    Transform place;
  };

  [[noreturn]] void fail(const std::string& sentence) const { throw Error(ErrorCode::file, path_, sentence); }

  static bool has_uvs(const aiMesh& mesh, unsigned int set) {
    return set < AI_MAX_NUMBER_OF_TEXTURECOORDS && mesh.HasTextureCoords(set);
  }

  const AssimpMaterial& material_of(const aiMesh& mesh) {
    static const AssimpMaterial standard;
    if (mesh.mMaterialIndex >= converted_.size() || scene_.mMaterials[mesh.mMaterialIndex] == nullptr) return standard;
    std::optional<AssimpMaterial>& converted = converted_[mesh.mMaterialIndex];
    if (!converted) converted = materials_.convert(*scene_.mMaterials[mesh.mMaterialIndex]);
    return *converted;
  }

  void walk() {
    struct Open {
      const aiNode* node;
      Transform parent;
    };
    std::vector<Open> open{{scene_.mRootNode, {}}};
    std::vector<bool> is_placed(scene_.mNumMeshes);
    while (!open.empty()) {
      const auto [node, parent] = open.back();
      open.pop_back();
      if (node == nullptr) continue;  // some readers count more children than they make
      const Transform place = then(transform_of(node->mTransformation), parent);
      for (unsigned int i = 0; i < node->mNumMeshes; ++i) {
        if (node->mMeshes[i] >= scene_.mNumMeshes) fail("a node names a mesh that is not there");
        is_placed[node->mMeshes[i]] = true;
        take_mesh(scene_.mMeshes[node->mMeshes[i]], place);
      }
      if (!camera_) take_camera(*node, place);
      for (unsigned int i = node->mNumChildren; i-- > 0;) open.push_back({node->mChildren[i], place});
    }
    if (std::find(is_placed.begin(), is_placed.end(), false) != is_placed.end()) {
      notes_.add("a mesh that no node places is left out");
    }
  }

  void take_mesh(const aiMesh* mesh, const Transform& place) {
    if (mesh == nullptr || !mesh->HasPositions()) return;
    if ((mesh->mPrimitiveTypes & (aiPrimitiveType_POINT | aiPrimitiveType_LINE)) != 0) {
      notes_.add("points and lines are left out");
    }
    if (mesh->mNumBones > 0) notes_.add("bones have no effect; the mesh is shown as it is without them");
    if ((mesh->mPrimitiveTypes & aiPrimitiveType_TRIANGLE) != 0) instances_.push_back({mesh, place});
  }

  void take_camera(const aiNode& node, const Transform& place) {
    for (unsigned int i = 0; i < scene_.mNumCameras; ++i) {
      const aiCamera& from = *scene_.mCameras[i];
      if (from.mName != node.mName) continue;
      const Vec3d eye = place.point(vector_of(from.mPosition));
      const Vec3d forward = place.vector(vector_of(from.mLookAt)), up = place.vector(vector_of(from.mUp));
      const Vec3d right = cross(forward, up);
      const double length = std::sqrt(dot(forward, forward));
      const double aspect = from.mAspect > 0 ? from.mAspect : 1;
      const double fov = 2 * std::atan(std::tan(from.mHorizontalFOV / 2.0) / aspect) * 180 / std::numbers::pi;
      const bool is_perspective = from.mOrthographicWidth == 0 && fov > 0 && fov < 180;
      if (!is_perspective || !(dot(right, right) > 0) || !std::isfinite(length)) {
        notes_.add("cameras that are not perspective have no effect");
        continue;
      }
      camera_ = Camera{eye, eye + forward / length, up / std::sqrt(dot(up, up)), fov};
      return;
    }
  }

  MeshBuilder::Counts count(const aiMesh& mesh) {
    const uint64_t vertices = mesh.mNumVertices;
    return {vertices, mesh.HasNormals() ? vertices : 0, has_uvs(mesh, material_of(mesh).uv_set) ? vertices : 0,
            mesh.mNumFaces};
  }

  void copy(const Instance& instance) {
    const aiMesh& mesh = *instance.mesh;
    builder_.set_place(instance.place);
    MeshBuilder::Part part;
    part.material = mesh.mMaterialIndex < converted_.size() ? mesh.mMaterialIndex : 0;
    const size_t count = mesh.mNumVertices;
    part.vertices = builder_.add_vertices(count);
    for (size_t i = 0; i < count; ++i) builder_.set_vertex(part.vertices + i, vector_of(mesh.mVertices[i]));
    if (mesh.HasNormals()) {
      part.normals = builder_.add_normals(count);
      for (size_t i = 0; i < count; ++i) builder_.set_normal(part.normals + i, vector_of(mesh.mNormals[i]));
    }
    if (const unsigned int set = material_of(mesh).uv_set; has_uvs(mesh, set)) {
      part.uvs = builder_.add_uvs(count);
      const aiVector3D* uvs = mesh.mTextureCoords[set];
      for (size_t i = 0; i < count; ++i) builder_.set_uv(part.uvs + i, uvs[i].x, uvs[i].y);
    }
    builder_.begin_part(part);
    for (unsigned int i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices != 3) continue;  // points and lines stand in meshes of triangles too
      const unsigned int* corner = face.mIndices;
      if (std::max({corner[0], corner[1], corner[2]}) >= count) fail("a face names a vertex that is not there");
      builder_.add_triangle(corner[0], corner[1], corner[2]);
    }
  }

  const aiScene& scene_;
  const std::string& path_;
  Notes notes_;
  AssimpMaterials materials_;
  std::vector<std::optional<AssimpMaterial>> converted_;  // those that are used
  std::vector<Instance> instances_;
  std::optional<Camera> camera_;
  MeshBuilder builder_;
};

/// Readers that we leave out: OpenGEX's writes what it finds wrong to the standard error, which is not ours to write
/// to; the others end the program over damaged files, 2 to 15 of a hundred with a few bytes changed (Assimp 5.2).
void unregister_unsafe(Assimp::Importer& importer) {
  for (const char* extension : {".ogex", ".iqm", ".cob", ".ase", ".md5mesh", ".sib"}) {
    const size_t number = importer.GetImporterIndex(extension);
    if (number == static_cast<size_t>(-1)) continue;
    Assimp::BaseImporter* unsafe = importer.GetImporter(number);
    if (importer.UnregisterLoader(unsafe) == aiReturn_SUCCESS) delete unsafe;
  }
}

/// Some readers say of a mesh that it has polygons where it has none, over which the step that cuts them ends the
/// program.
void repair_primitive_types(const aiScene& scene) {
  for (unsigned int i = 0; i < scene.mNumMeshes; ++i) {
    aiMesh* mesh = scene.mMeshes[i];
    if (mesh == nullptr) continue;
    unsigned int types = 0;
    for (unsigned int k = 0; k < mesh->mNumFaces; ++k) {
      const unsigned int corners = mesh->mFaces[k].mNumIndices;
      if (corners > 0) types |= AI_PRIMITIVE_TYPE_FOR_N_INDICES(corners);
    }
    mesh->mPrimitiveTypes = types == 0 ? unsigned{aiPrimitiveType_POINT} : types;  // 0 would be guessed at
  }
}

const aiScene* import(Assimp::Importer& importer, const std::string& path) {
  unregister_unsafe(importer);
  // Joining compares all that a vertex has, so what is not used goes first.
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS,
                              aiComponent_COLORS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_BONEWEIGHTS);
  const aiScene* scene = importer.ReadFile(path, aiProcess_RemoveComponent | aiProcess_TransformUVCoords);
  if (scene == nullptr) return nullptr;
  repair_primitive_types(*scene);
  return importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_JoinIdenticalVertices);
}

}  // namespace

Model read_with_assimp(const std::string& path) {
  std::error_code status;
  if (std::filesystem::exists(path, status) && std::filesystem::is_other(path, status)) {
    throw Error(ErrorCode::file, path, "is not a regular file");  // Assimp goes back and forth in what it reads
  }
  check_for_assimp(MappedFile(path).bytes(), path);  // and says it better than Assimp where there is no such file
  const AssimpAssertions assertions;
  try {
    Assimp::Importer importer;
    const aiScene* scene = import(importer, path);
    if (scene == nullptr) {
      throw Error(ErrorCode::file, path,
                  fmt::format("cannot be read by Assimp: {}", first_line(importer.GetErrorString())));
    }
    return Converter(*scene, path).convert();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(ErrorCode::file, path, fmt::format("cannot be read by Assimp: {}", first_line(error.what())));
  }
}

std::vector<std::string> assimp_extensions() {
  std::string list;  // "*.3ds;*.obj"
  Assimp::Importer importer;
  unregister_unsafe(importer);
  importer.GetExtensionList(list);
  std::vector<std::string> extensions;
  for (size_t begin = 0; begin < list.size();) {
    const size_t end = std::min(list.find(';', begin), list.size());
    const std::string_view entry = std::string_view(list).substr(begin, end - begin);
    if (entry.starts_with("*.")) extensions.emplace_back(entry.substr(1));
    begin = end + 1;
  }
  std::sort(extensions.begin(), extensions.end());
  extensions.erase(std::unique(extensions.begin(), extensions.end()), extensions.end());
  return extensions;
}

}  // namespace kerf
