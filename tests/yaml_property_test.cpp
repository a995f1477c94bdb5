// Any valid scene, written as YAML in any style, reads back as it was.

#include <gtest/gtest.h>

#include <fmt/format.h>

#include "kerf/geometry/hit.h"
#include "support/property.h"
#include "yaml_text.h"

namespace kerf::test {
namespace {

/// A primitive with what the file says of it: for a sphere {center, (radius, 0, 0)}, else three vectors; of a triangle
/// three normals more if it has them.
struct Item {
  std::string type;
  uint32_t material = 0;
  bool visible = true;
  std::vector<Vec3f> vectors;

  friend bool operator==(const Item&, const Item&) = default;
};

struct Written {
  Camera camera;
  Background background;
  std::string name;
  std::vector<Material> materials;
  std::vector<Item> items;
};

bool draw_bool() { return draw_int(0, 1) == 1; }

std::string draw_text(size_t most) {
  const std::string letters = "abcdefgh:#-'\"\\ {}[],&*!|>%@`~0\xC3\xA9";
  std::string text(static_cast<size_t>(draw_int(1, static_cast<int>(most))), ' ');
  for (char& c : text) c = letters[static_cast<size_t>(draw_int(0, static_cast<int>(letters.size()) - 1))];
  return text;
}

/// Of sizes from 1e-30 to 1e30, and 0.
Vec3f draw_any_vector() {
  const Vec3f v = draw_vector();
  return draw_bool() ? v : v * std::ldexp(1.0F, draw_int(-100, 100));
}

Vec3f draw_color(float most) {
  const float r = draw_share(), g = draw_share(), b = draw_share();
  return Vec3f{r, g, b} * most;
}

Material draw_material(size_t number) {
  Material m;
  m.name = draw_text(6) + std::to_string(number);
  m.type = static_cast<MaterialType>(draw_int(0, static_cast<int>(material_types().size()) - 1));
  const bool has_albedo = m.type != MaterialType::light && m.type != MaterialType::show_normals;
  if (has_albedo) m.albedo = draw_color(m.type == MaterialType::constant ? 9.0F : 1.0F);
  if (m.type == MaterialType::light || draw_bool()) m.emission = draw_color(100) + Vec3f{0.5F, 0, 0};
  if (m.type == MaterialType::metal) {
    m.roughness = draw_share();
    m.metallic = draw_share();
  }
  if (m.type == MaterialType::glass) {
    m.refractive_index = 1 + draw_share();
    m.transmission = draw_share();
  }
  return m;
}

Item draw_item(size_t materials) {
  const char* types[] = {"sphere", "rectangle", "triangle"};
  const int type = draw_int(0, 4);  // more triangles, so that some follow each other
  Item item{
      types[std::min(type, 2)], static_cast<uint32_t>(draw_int(0, static_cast<int>(materials) - 1)), draw_bool(), {}};
  if (item.type == "sphere") {
    item.vectors = {draw_any_vector(), {1 + draw_share(), 0, 0}};
  } else if (item.type == "rectangle") {
    item.vectors = {draw_any_vector(), {1 + draw_share(), 0, draw_share()}, {0, -1 - draw_share(), 0}};
  } else {
    for (int i = 0; i < 3; ++i) item.vectors.push_back(draw_any_vector());
    for (int i = 0; i < 3 && (i > 0 ? item.vectors.size() > 3 : draw_bool()); ++i) {
      item.vectors.push_back(draw_any_vector() + Vec3f{0, 2e35F, 0});
    }
  }
  return item;
}

Written draw_scene() {
  Written scene;
  scene.camera = {
      to_double(draw_vector()), to_double(draw_vector()) + Vec3d{0, 0, 9}, {0, 1, 0.25}, 1 + 170 * draw_share()};
  scene.background = {draw_color(3), draw_share(), draw_share()};
  scene.name = draw_text(20);
  for (int i = draw_int(1, 4); i > 0; --i) scene.materials.push_back(draw_material(scene.materials.size()));
  for (int i = draw_int(0, 12); i > 0; --i) scene.items.push_back(draw_item(scene.materials.size()));
  return scene;
}

/// Writes keys and values in block or flow style, as chance has it.
class Writer {
 public:
  std::string text(const Written& scene) {
    begin("scene");
    key("name", quote(scene.name));
    begin("camera", 1);
    key("position", vector(scene.camera.eye, 2), 1);
    key("look_at", vector(scene.camera.look_at, 2), 1);
    key("up", vector(scene.camera.up, 2), 1);
    key("fov", number(scene.camera.fov), 1);
    begin("settings");
    key("background_color", vector(to_double(scene.background.color), 1));
    key("background_intensity", number(scene.background.intensity));
    key("ambient_light", number(scene.background.ambient));
    begin("materials");
    for (const Material& m : scene.materials) material(m);
    if (!scene.items.empty()) begin("geometry");
    for (const Item& i : scene.items) item(i, scene.materials[i.material].name);
    return text_;
  }

 private:
  static std::string number(double x) { return draw_bool() ? fmt::format("{}", x) : fmt::format("{:+.17e}", x); }

  static std::string vector(Vec3d v, size_t depth) {
    const std::string x = number(v.x), y = number(v.y), z = number(v.z);
    if (draw_bool()) return fmt::format("[{}, {},{}]", x, y, z);
    const std::string line = "\n" + std::string(2 * depth + 2, ' ') + "- ";
    return line + x + " # x" + line + y + line + z;
  }

  static std::string quote(const std::string& text) {
    const bool twice = draw_bool();
    std::string quoted;
    for (const char c : text) {
      if (twice ? c == '"' || c == '\\' : c == '\'') quoted += twice ? '\\' : '\'';
      quoted += c;
    }
    return twice ? '"' + quoted + '"' : '\'' + quoted + '\'';
  }

  void begin(const std::string& word, size_t depth = 0) { text_ += std::string(2 * depth, ' ') + word + ":\n"; }
  void key(const std::string& word, const std::string& value, size_t depth = 0) {
    text_ += std::string(2 * depth + 2, ' ') + word + ": " + value + "\n";
  }
  /// The first key of an item has the dash.
  void entry(const std::string& word, const std::string& value, bool is_first = false) {
    text_ += (is_first ? "  - " : "    ") + word + ": " + value + "\n";
  }

  void material(const Material& m) {
    entry("name", quote(m.name), true);
    if (m.type != MaterialType::lambertian || draw_bool()) {
      entry("type", std::string(material_types()[static_cast<size_t>(m.type)].name));
    }
    const bool has_albedo = m.type != MaterialType::light && m.type != MaterialType::show_normals;
    if (has_albedo) entry("albedo", vector(to_double(m.albedo), 2));
    if (m.emission != Vec3f{}) entry("emission", vector(to_double(m.emission), 2));
    if (m.type == MaterialType::metal) {
      entry("roughness", number(m.roughness));
      entry("metallic", number(m.metallic));
    }
    if (m.type == MaterialType::glass) {
      entry("refractive_index", number(m.refractive_index));
      entry("transmission", number(m.transmission));
    }
  }

  void item(const Item& item, const std::string& material) {
    entry("type", item.type, true);
    entry("material", quote(material));
    if (!item.visible || draw_bool()) entry("visible", item.visible ? "true" : "false");
    if (item.type == "sphere") {
      entry("center", vector(to_double(item.vectors[0]), 2));
      entry("radius", number(item.vectors[1].x));
      return;
    }
    const std::vector<std::string> rectangle = {"corner", "u", "v"}, triangle = {"v0", "v1", "v2", "n0", "n1", "n2"};
    const std::vector<std::string>& words = item.type == "rectangle" ? rectangle : triangle;
    for (size_t i = 0; i < item.vectors.size(); ++i) entry(words[i], vector(to_double(item.vectors[i]), 2));
  }

  std::string text_;
};

void append_triangles(const SceneObject& object, const Mesh& mesh, std::vector<Item>& items) {
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    Item item{"triangle", mesh.materials.empty() ? object.material : mesh.materials.at(i), object.visible, {}};
    for (const uint32_t k : mesh.triangles[i]) item.vectors.push_back(mesh.vertices.at(k));
    const Mesh::Corners normals = (mesh.normal_corners.empty() ? mesh.triangles : mesh.normal_corners).at(i);
    if (!mesh.normals.empty() && normals[0] != kNone) {
      for (const uint32_t k : normals) item.vectors.push_back(mesh.normals.at(k));
    }
    items.push_back(item);
  }
}

std::vector<Item> items_of(const SceneDescription& scene) {
  std::vector<Item> items;
  for (const SceneObject& object : scene.objects) {
    if (const auto* mesh = std::get_if<Mesh>(&object.shape)) {
      append_triangles(object, *mesh, items);
    } else if (const auto* sphere = std::get_if<Sphere>(&object.shape)) {
      items.push_back({"sphere", object.material, object.visible, {sphere->center, {sphere->radius, 0, 0}}});
    } else {
      const auto& shape = std::get<Parallelogram>(object.shape);
      items.push_back({"rectangle", object.material, object.visible, {shape.corner, shape.u, shape.v}});
    }
  }
  return items;
}

void expect_same(const SceneDescription& read, const Written& scene) {
  RC_ASSERT(read.name == scene.name);
  RC_ASSERT(read.camera->eye == scene.camera.eye);
  RC_ASSERT(read.camera->look_at == scene.camera.look_at);
  RC_ASSERT(read.camera->up == scene.camera.up);
  RC_ASSERT(read.camera->fov == scene.camera.fov);
  RC_ASSERT(read.background.color == scene.background.color);
  RC_ASSERT(read.background.intensity == scene.background.intensity);
  RC_ASSERT(read.background.ambient == scene.background.ambient);
  RC_ASSERT(read.materials.size() == scene.materials.size());
  for (size_t i = 0; i < read.materials.size(); ++i) {
    const Material &a = read.materials[i], &b = scene.materials[i];
    RC_ASSERT(a.name == b.name);
    RC_ASSERT(a.type == b.type);
    RC_ASSERT(a.albedo == b.albedo);
    RC_ASSERT(a.emission == b.emission);
    RC_ASSERT(a.roughness == b.roughness);
    RC_ASSERT(a.metallic == b.metallic);
    RC_ASSERT(a.refractive_index == b.refractive_index);
    RC_ASSERT(a.transmission == b.transmission);
  }
  RC_ASSERT(items_of(read) == scene.items);
}

TEST(YamlProperty, AnySceneReadsBackAsItWas) {
  check_property(300, [] {
    const Written scene = draw_scene();
    const std::string text = Writer().text(scene);
    RC_LOG() << text;
    expect_same(parse(text), scene);
  });
}

}  // namespace
}  // namespace kerf::test
