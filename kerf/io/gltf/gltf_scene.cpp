#include "kerf/io/gltf/gltf_scene.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace kerf {
namespace {

class Walker {
 public:
  explicit Walker(GltfFile& file) : file_(file), is_met_(file.json.nodes.size()) {}

  GltfScene walk() {
    const std::vector<int> roots = find_roots();
    for (size_t i = roots.size(); i-- > 0;) open_.push_back({roots[i], {}});
    while (!open_.empty()) {
      const Open open = open_.back();
      open_.pop_back();
      visit(open.node, open.parent);
    }
    if (file_.json.scenes.empty()) refuse_unmet();
    return std::move(scene_);
  }

 private:
  struct Open {
    int node;
    Transform parent;
  };

  std::vector<int> find_roots() const {
    const tinygltf::Model& json = file_.json;
    if (json.defaultScene >= 0) return file_.member(json.scenes, json.defaultScene, "scenes", "scene").nodes;
    if (!json.scenes.empty()) return json.scenes.front().nodes;
    std::vector<bool> is_child(json.nodes.size());
    for (size_t i = 0; i < json.nodes.size(); ++i) {
      for (const int child : json.nodes[i].children) {
        file_.member(json.nodes, child, "nodes", fmt::format("nodes[{}].children", i));
        is_child[static_cast<size_t>(child)] = true;
      }
    }
    std::vector<int> roots;
    for (size_t i = 0; i < json.nodes.size(); ++i) {
      if (!is_child[i]) roots.push_back(static_cast<int>(i));
    }
    return roots;
  }

  /// Without scenes every node hangs from a root, but for those in a circle.
  void refuse_unmet() const {
    for (size_t i = 0; i < is_met_.size(); ++i) {
      if (!is_met_[i]) file_.fail(fmt::format("nodes[{}] is among its own children's children", i));
    }
  }

  void visit(int number, const Transform& parent) {
    const tinygltf::Node& node = file_.member(file_.json.nodes, number, "nodes", "the scene");
    const auto index = static_cast<size_t>(number);
    if (is_met_[index]) file_.fail(fmt::format("nodes[{}] stands twice in the tree of nodes", number));
    is_met_[index] = true;
    const Transform place = then(local_transform(node, number), parent);
    const std::string name = fmt::format("nodes[{}]", number);
    if (node.mesh >= 0) {
      file_.member(file_.json.meshes, node.mesh, "meshes", name);
      scene_.instances.push_back({node.mesh, place});
      if (node.skin >= 0) file_.notes.add("skins have no effect; the mesh is shown as it is without one", name);
    }
    if (node.camera >= 0)
      take_camera(file_.member(file_.json.cameras, node.camera, "cameras", name), node.camera, place);
    if (node.extensions.count("KHR_lights_punctual") > 0) file_.notes.add("lights of the file have no effect", name);
    if (node.extensions.count("EXT_mesh_gpu_instancing") > 0) {
      file_.notes.add("EXT_mesh_gpu_instancing has no effect; the mesh is shown once", name);
    }
    for (size_t i = node.children.size(); i-- > 0;) open_.push_back({node.children[i], place});
  }

  Transform local_transform(const tinygltf::Node& node, int number) const {
    const auto check = [&](const std::vector<double>& values, size_t expected, const char* name) {
      if (values.empty() || values.size() == expected) return;
      file_.fail(fmt::format("nodes[{}].{} has {} numbers; expected {}", number, name, values.size(), expected));
    };
    check(node.matrix, 16, "matrix");
    check(node.translation, 3, "translation");
    check(node.rotation, 4, "rotation");
    check(node.scale, 3, "scale");
    return node.matrix.empty() ? from_parts(node, number) : from_matrix(node.matrix, number);
  }

  Transform from_matrix(const std::vector<double>& m, int number) const {
    constexpr double kTolerance = 1e-5;  // what writers leave in the last row
    if (std::abs(m[3]) > kTolerance || std::abs(m[7]) > kTolerance || std::abs(m[11]) > kTolerance ||
        std::abs(m[15] - 1) > kTolerance) {
      file_.fail(fmt::format("nodes[{}].matrix is no affine transform: its last row is {}, {}, {}, {}", number, m[3],
                             m[7], m[11], m[15]));
    }
    return {{{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}}, {m[12], m[13], m[14]}};
  }

  Transform from_parts(const tinygltf::Node& node, int number) const {
    Transform place;
    if (!node.rotation.empty()) {
      double x = node.rotation[0], y = node.rotation[1], z = node.rotation[2], w = node.rotation[3];
      const double length = std::hypot(std::hypot(x, y), std::hypot(z, w));
      if (!(length > 0)) file_.fail(fmt::format("nodes[{}].rotation is a quaternion of length 0", number));
      x /= length, y /= length, z /= length, w /= length;
      place.column[0] = {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)};
      place.column[1] = {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)};
      place.column[2] = {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)};
    }
    if (!node.scale.empty()) {
      for (size_t i = 0; i < 3; ++i) place.column[i] = place.column[i] * node.scale[i];
    }
    if (!node.translation.empty()) place.translation = {node.translation[0], node.translation[1], node.translation[2]};
    return place;
  }

  void take_camera(const tinygltf::Camera& camera, int number, const Transform& place) {
    const std::string name = fmt::format("cameras[{}]", number);
    if (camera.type != "perspective") {
      file_.notes.add("cameras that are not perspective have no effect", name);
      return;
    }
    if (scene_.camera) return;
    const double fov = camera.perspective.yfov * 180 / std::numbers::pi;
    if (!(fov > 0 && fov < 180)) {
      file_.fail(fmt::format("{}.perspective.yfov is {}; expected more than 0 and less than pi", name,
                             camera.perspective.yfov));
    }
    const Vec3d forward = place.vector({0, 0, -1}), up = place.vector({0, 1, 0});
    const double length = std::sqrt(dot(forward, forward)), height = std::sqrt(dot(up, up));
    if (!(length > 0 && height > 0 && std::isfinite(length) && std::isfinite(height))) {
      file_.notes.add("a camera that its node makes flat has no effect", name);
      return;
    }
    const Vec3d eye = place.translation;
    scene_.camera = Camera{eye, eye + forward / length, up / height, fov};
  }

  GltfFile& file_;
  std::vector<bool> is_met_;
  std::vector<Open> open_;
  GltfScene scene_;
};

}  // namespace

GltfScene walk_gltf_scene(GltfFile& file) { return Walker(file).walk(); }

}  // namespace kerf
