#include "kerf/io/yaml/yaml_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "kerf/base/nearest_word.h"
#include "kerf/geometry/geometry.h"
#include "kerf/geometry/hit.h"
#include "kerf/io/message.h"

namespace kerf {
namespace {

constexpr std::string_view kSphereKeys[] = {"type", "material", "visible", "center", "radius"};
constexpr std::string_view kRectangleKeys[] = {"type", "material", "visible", "corner", "u", "v"};
constexpr std::string_view kTriangleKeys[] = {"type", "material", "visible", "v0", "v1", "v2", "n0", "n1", "n2"};
constexpr std::string_view kModelKeys[] = {"type", "material", "visible", "file", "filename", "position", "scale"};
constexpr std::string_view kFutureTypes[] = {"displaced_sphere", "sdf_primitive"};

class GeometryReader {
 public:
  GeometryReader(const YamlMaterials& materials, SceneDescription& scene, YamlModels& models, Notes& notes)
      : materials_(materials), scene_(scene), models_(models), notes_(notes) {}

  void read(const YamlField& item) {
    const std::optional<YamlField> type = peek(item, "type");
    if (!type) item.node().fail("an item of the geometry needs 'type'");
    const std::string word = type->text();
    const auto* kind =
        std::find_if(std::begin(kKinds), std::end(kKinds), [&](const Kind& k) { return k.name == word; });
    if (kind == std::end(kKinds)) refuse_type(*type, word);
    const YamlMap map(item, kind->keys, std::string(kind->noun));
    SceneObject object;
    object.place = item.place();
    if (const auto field = map.find("visible")) object.visible = field->boolean();
    if (const auto field = map.find("material")) {
      object.material = materials_.number_of(*field);
    } else if (!kind->may_lack_material) {
      map.require("material");
    }
    (this->*kind->read)(map, std::move(object));
  }

 private:
  struct Kind {
    std::string_view name, noun;
    std::span<const std::string_view> keys;
    bool may_lack_material;
    void (GeometryReader::*read)(const YamlMap& map, SceneObject object);
  };
  static const Kind kKinds[4];

  [[noreturn]] static void refuse_type(const YamlField& type, std::string_view word) {
    if (std::find(std::begin(kFutureTypes), std::end(kFutureTypes), word) != std::end(kFutureTypes)) {
      type.node().fail(fmt::format("the shape '{}' is not there yet", word));
    }
    std::vector<std::string_view> menu;
    for (const Kind& kind : kKinds) menu.push_back(kind.name);
    type.node().fail(fmt::format("unknown shape {}", quoted(word)) + suggestion(word, menu));
  }

  void add(SceneObject object) {
    scene_.objects.push_back(std::move(object));
    last_is_triangles_ = false;
  }

  void read_sphere(const YamlMap& map, SceneObject object) {
    object.shape = Sphere{map.require("center").single_vector(), map.require("radius").single(kAboveZero)};
    add(std::move(object));
  }

  void read_rectangle(const YamlMap& map, SceneObject object) {
    const YamlField edge_v = map.require("v");
    const Vec3d u = map.require("u").vector(), v = edge_v.vector();
    const Parallelogram shape{map.require("corner").single_vector(), to_float(u), to_float(v)};
    const Strided<Parallelogram> shapes(&shape, 1);
    // Judged as it was written, where rounding is no concern yet, and as it will be.
    const Vec3d normal = cross(u, v);
    const bool is_parallel = !(dot(normal, normal) > 1e-24 * dot(u, u) * dot(v, v));
    if (is_parallel || is_degenerate({shapes}, 0)) edge_v.fail("u and v must be neither zero nor parallel");
    if (find_defect({shapes}, 0) != Defect::none) map.node().fail("the far corner lies beyond 2^120 (1.3e36)");
    object.shape = shape;
    add(std::move(object));
  }

  void read_triangle(const YamlMap& map, SceneObject object) {
    const std::array<Vec3f, 3> corners = {map.require("v0").single_vector(), map.require("v1").single_vector(),
                                          map.require("v2").single_vector()};
    const std::optional<std::array<Vec3f, 3>> normals = read_normals(map);
    constexpr TriangleCorners kOnly = {0, 1, 2};
    if (is_degenerate({TriangleMesh{corners, {&kOnly, 1}}}, 0)) {
      notes_.add("a triangle without area is never hit", object.place);
    }
    const uint32_t material = object.material;
    Mesh& mesh = mesh_for(std::move(object));
    mesh.materials.push_back(material);
    append(mesh, corners, normals);
  }

  static std::optional<std::array<Vec3f, 3>> read_normals(const YamlMap& map) {
    const std::optional<YamlField> fields[3] = {map.find("n0"), map.find("n1"), map.find("n2")};
    if (!fields[0] && !fields[1] && !fields[2]) return std::nullopt;
    std::array<Vec3f, 3> normals;
    for (size_t i = 0; i < 3; ++i) {
      if (!fields[i]) map.node().fail(fmt::format("a triangle has 'n0', 'n1' and 'n2' or none; 'n{}' is missing", i));
      normals[i] = fields[i]->single_vector();
      if (normals[i] == Vec3f{}) fields[i]->fail("a normal must not be zero");
    }
    return normals;
  }

  /// The mesh that the triangle before went into, if this one may too; else a new one.
  Mesh& mesh_for(SceneObject object) {
    if (!last_is_triangles_ || scene_.objects.back().visible != object.visible) {
      add(std::move(object));
      last_is_triangles_ = true;
    }
    return *std::get_if<Mesh>(&scene_.objects.back().shape);
  }

  static void append(Mesh& mesh, const std::array<Vec3f, 3>& corners,
                     const std::optional<std::array<Vec3f, 3>>& normals) {
    const auto triangles_before = mesh.triangles.size();
    const auto first = static_cast<uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), corners.begin(), corners.end());
    mesh.triangles.push_back({first, first + 1, first + 2});
    // As long as all triangles have normals, or none has, corner numbers would say nothing new.
    const bool all_have = mesh.normals.size() == 3 * triangles_before, none_has = mesh.normals.empty();
    if (mesh.normal_corners.empty() && triangles_before > 0 && (normals ? !all_have : !none_has)) {
      mesh.normal_corners.assign(triangles_before, {kNone, kNone, kNone});
      if (all_have) std::copy_n(mesh.triangles.begin(), triangles_before, mesh.normal_corners.begin());
    }
    const auto first_normal = static_cast<uint32_t>(mesh.normals.size());
    if (normals) mesh.normals.insert(mesh.normals.end(), normals->begin(), normals->end());
    if (mesh.normal_corners.empty()) return;
    mesh.normal_corners.push_back(normals ? Mesh::Corners{first_normal, first_normal + 1, first_normal + 2}
                                          : Mesh::Corners{kNone, kNone, kNone});
  }

  void read_model(const YamlMap& map, SceneObject object) {
    const std::optional<YamlField> file = map.find_either("file", "filename");
    Vec3d scale{1, 1, 1}, position;
    if (const auto field = map.find("scale")) scale = read_scale(*field);
    if (const auto field = map.find("position")) position = field->vector();
    models_.place(scene_.objects.size(), file ? *file : map.require("file"), scale, position,
                  map.find("material").has_value());
    object.shape = Mesh{};
    add(std::move(object));
  }

  static Vec3d read_scale(const YamlField& field) {
    Vec3d scale;
    if (field.node().kind() == YamlKind::scalar) {
      const double one = field.number();
      scale = {one, one, one};
    } else if (field.node().kind() == YamlKind::sequence && field.node().size() == 3) {
      scale = field.vector();
    } else {
      field.fail_type("a number or three of them");
    }
    if (scale.x == 0 || scale.y == 0 || scale.z == 0) field.fail("no component may be 0");
    return scale;
  }

  const YamlMaterials& materials_;
  SceneDescription& scene_;
  YamlModels& models_;
  Notes& notes_;
  bool last_is_triangles_ = false;  // the last object is a mesh of triangles of this section
};

const GeometryReader::Kind GeometryReader::kKinds[4] = {
    {"sphere", "a sphere", kSphereKeys, false, &GeometryReader::read_sphere},
    {"rectangle", "a rectangle", kRectangleKeys, false, &GeometryReader::read_rectangle},
    {"triangle", "a triangle", kTriangleKeys, false, &GeometryReader::read_triangle},
    {"obj", "an obj", kModelKeys, true, &GeometryReader::read_model},
};

}  // namespace

void read_yaml_geometry(const YamlField& section, const YamlMaterials& materials, SceneDescription& scene,
                        YamlModels& models, Notes& notes) {
  GeometryReader reader(materials, scene, models, notes);
  for (const YamlField& item : items_of(section)) reader.read(item);
}

}  // namespace kerf
