// What a YAML scene says arrives as it stands there, and docs/scenes.md is right.

#include <gtest/gtest.h>

#include <fstream>
#include <regex>

#include "kerf/geometry/hit.h"
#include "support/folder.h"
#include "yaml_text.h"

namespace kerf::test {
namespace {

TEST(YamlScene, EmptyFilesAndSectionsAreASceneOfSkyWithDefaults) {
  for (const std::string text :
       {"", "# nothing\n", "---\n", "{}", "camera:\nsettings:\nmaterials:\ngeometry:\nscene:\n", "materials: []"}) {
    SCOPED_TRACE(text);
    const SceneDescription scene = parse(text);
    ASSERT_TRUE(scene.camera);
    EXPECT_EQ(scene.camera->eye, (Vec3d{0, 0, 0}));
    EXPECT_EQ(scene.camera->look_at, (Vec3d{0, 0, -1}));
    EXPECT_EQ(scene.camera->up, (Vec3d{0, 1, 0}));
    EXPECT_EQ(scene.camera->fov, 90);
    EXPECT_EQ(scene.background.color, (Vec3f{0.5F, 0.7F, 1.0F}));
    EXPECT_EQ(scene.background.intensity, 1);
    EXPECT_EQ(scene.background.ambient, 0.1F);
    EXPECT_EQ(scene.structure + scene.structure_place + scene.name + scene.description, "");
    EXPECT_TRUE(scene.is_lit);
    EXPECT_TRUE(scene.objects.empty() && scene.materials.empty() && scene.textures.empty() && scene.notes.empty());
  }
}

TEST(YamlScene, ReadsCameraAndSettings) {
  const SceneDescription scene = parse(
      "camera:\n  position: [1, 2.5, -3e0]\n  look_at:\n    - .5\n    - +4\n    - 0\n  up: [0, 0, 1.]\n  fov: 40\n"
      "settings: {background_color: [0, 2, 3.5], background_intensity: 0.25, ambient_light: 0,\n"
      "           structure: 'early_split(budget=1.5)+binned_sah', use_bvh: true, adaptive_sampling: false}\n");
  EXPECT_EQ(scene.camera->eye, (Vec3d{1, 2.5, -3}));
  EXPECT_EQ(scene.camera->look_at, (Vec3d{0.5, 4, 0}));
  EXPECT_EQ(scene.camera->up, (Vec3d{0, 0, 1}));
  EXPECT_EQ(scene.camera->fov, 40);
  EXPECT_EQ(scene.background.color, (Vec3f{0, 2, 3.5F}));
  EXPECT_EQ(scene.background.intensity, 0.25F);
  EXPECT_EQ(scene.background.ambient, 0);
  EXPECT_EQ(scene.structure, "early_split(budget=1.5)+binned_sah");
  EXPECT_EQ(scene.structure_place, "t.yaml:10:23");
  EXPECT_TRUE(scene.notes.empty());
}

TEST(YamlScene, TheSceneBlockHoldsNameCameraAndSettings) {
  const SceneDescription scene = parse(
      "scene:\n  name: \"A room\"\n  description: ''\n  camera: {fov: 30}\n  ambient_light: 0.5\n  use_bvh: false\n"
      "settings: {background_intensity: 0}\n");
  EXPECT_EQ(scene.name, "A room");
  EXPECT_EQ(scene.description, "");
  EXPECT_EQ(scene.camera->fov, 30);
  EXPECT_EQ(scene.background.ambient, 0.5F);
  EXPECT_EQ(scene.background.intensity, 0);
  EXPECT_EQ(scene.structure, "brute_force");
  EXPECT_EQ(scene.structure_place, "t.yaml:6:12");
}

TEST(YamlScene, AdaptiveSamplingIsNotedWhereItIsAskedFor) {
  const SceneDescription scene = parse("settings:\n  adaptive_sampling: true\n");
  ASSERT_EQ(scene.notes.size(), 1U);
  EXPECT_EQ(scene.notes[0], "adaptive_sampling has no effect yet: all pixels get equal samples (t.yaml:2:22)");
}

TEST(YamlScene, ReadsEveryMaterialTypeWithItsDefaults) {
  const std::pair<const char*, MaterialType> types[] = {{"lambertian", MaterialType::lambertian},
                                                        {"mirror", MaterialType::mirror},
                                                        {"metal", MaterialType::metal},
                                                        {"rough_mirror", MaterialType::metal},
                                                        {"glass", MaterialType::glass},
                                                        {"dielectric", MaterialType::glass},
                                                        {"constant", MaterialType::constant},
                                                        {"show_normals", MaterialType::show_normals},
                                                        {"light, emission: [1, 0, 0]", MaterialType::light}};
  for (const auto& [word, type] : types) {
    SCOPED_TRACE(word);
    const SceneDescription scene = parse(with_material(std::string("name: x, type: ") + word));
    ASSERT_EQ(scene.materials.size(), 1U);
    const Material& m = scene.materials[0];
    EXPECT_EQ(m.name, "x");
    EXPECT_EQ(m.type, type);
    EXPECT_EQ(m.albedo, type == MaterialType::glass ? (Vec3f{1, 1, 1}) : (Vec3f{0.7F, 0.7F, 0.7F}));
    EXPECT_EQ(m.albedo_texture, kNoTexture);
    EXPECT_EQ(m.emission, (Vec3f{type == MaterialType::light ? 1.0F : 0.0F, 0, 0}));
    EXPECT_EQ(m.roughness, 0);
    EXPECT_EQ(m.metallic, 1);
    EXPECT_EQ(m.refractive_index, 1.5F);
    EXPECT_EQ(m.transmission, 1);
    EXPECT_TRUE(scene.notes.empty());
  }
  EXPECT_EQ(parse(with_material("name: 1")).materials[0].type, MaterialType::lambertian);
}

TEST(YamlScene, EmissionIsGivenWholeOrAsColorTimesIntensity) {
  const auto emission = [](const std::string& keys) {
    return parse(with_material("name: x, type: light, " + keys)).materials[0].emission;
  };
  EXPECT_EQ(emission("emission: [1, 2, 3]"), (Vec3f{1, 2, 3}));
  EXPECT_EQ(emission("color: [1, 0.5, 0], emission_intensity: 8"), (Vec3f{8, 4, 0}));
  EXPECT_EQ(emission("color: [1, 0.5, 0]"), (Vec3f{1, 0.5F, 0}));
  EXPECT_EQ(emission("emission_intensity: 8"), (Vec3f{8, 8, 8}));
  const SceneDescription scene = parse(with_material("name: x, color: [1, 0, 0]"));
  EXPECT_EQ(scene.materials[0].emission, (Vec3f{1, 0, 0}));
  ASSERT_EQ(scene.notes.size(), 1U);
  EXPECT_TRUE(scene.notes[0].starts_with("'color' without 'emission_intensity' makes a lambertian material shine"));
}

TEST(YamlScene, KeysWithoutAUseAreNotedOncePerTypeAndKey) {
  const SceneDescription scene = parse(
      "materials:\n"
      "  - {name: a, type: light, emission: [1, 1, 1], albedo: [2, 1, 1]}\n"
      "  - {name: b, type: light, emission: [1, 1, 1], albedo: [1, 1, 1]}\n"
      "  - {name: c, roughness: 7, type: lambertian}\n"
      "  - {name: d, type: light, emission: [1, 1, 1], albedo: [1, 1, 1]}\n"
      "  - {name: e, type: mirror, metallic: 0}\n"
      "  - {name: f, type: metal, roughness: 0.5, metallic: 0.25}\n"
      "  - {name: g, type: dielectric, refractive_index: 1.3, transmission: 0, metallic: 1}\n");
  EXPECT_EQ(scene.notes, (std::vector<std::string>{
                             "a light does not use 'albedo' (t.yaml:2:49 and 2 more)",
                             "a lambertian material does not use 'roughness' (t.yaml:4:15)",
                             "a mirror material does not use 'metallic' (t.yaml:6:29)",
                             "a glass material does not use 'metallic' (t.yaml:8:73)",
                         }));
  EXPECT_EQ(scene.materials[0].albedo, (Vec3f{0.7F, 0.7F, 0.7F}));
  EXPECT_EQ(scene.materials[2].roughness, 0);
  EXPECT_EQ(scene.materials[5].roughness, 0.5F);
  EXPECT_EQ(scene.materials[5].metallic, 0.25F);
  EXPECT_EQ(scene.materials[6].refractive_index, 1.3F);
  EXPECT_EQ(scene.materials[6].transmission, 0);
  EXPECT_EQ(parse(with_material("name: x, type: constant, albedo: [9, 0, 1]")).materials[0].albedo, (Vec3f{9, 0, 1}));
}

TEST(YamlScene, ReadsSpheresAndRectanglesInBothStyles) {
  for (const std::string section : {"geometry", "geometries"}) {
    const SceneDescription scene = parse(kMaterials + section +
                                         ":\n  - type: sphere\n    material: \"n\"\n    center:\n      - 1\n      - 2\n"
                                         "      - 3\n    radius: 0.5\n    visible: false\n"
                                         "  - {type: rectangle, material: m, corner: [0, 0, 0], u: [1, 0, 0], "
                                         "v: [0, 0, 2]}\n");
    ASSERT_EQ(scene.objects.size(), 2U);
    const auto& sphere = std::get<Sphere>(scene.objects[0].shape);
    EXPECT_EQ(sphere.center, (Vec3f{1, 2, 3}));
    EXPECT_EQ(sphere.radius, 0.5F);
    EXPECT_EQ(scene.objects[0].material, 1U);
    EXPECT_FALSE(scene.objects[0].visible);
    EXPECT_EQ(scene.objects[0].place, "t.yaml:6:5");
    const auto& rectangle = std::get<Parallelogram>(scene.objects[1].shape);
    EXPECT_EQ(rectangle.corner, (Vec3f{0, 0, 0}));
    EXPECT_EQ(rectangle.u, (Vec3f{1, 0, 0}));
    EXPECT_EQ(rectangle.v, (Vec3f{0, 0, 2}));
    EXPECT_EQ(scene.objects[1].material, 0U);
    EXPECT_TRUE(scene.objects[1].visible);
    EXPECT_EQ(scene.objects[1].place, "t.yaml:14:5");
  }
}

std::string triangle(const std::string& more, int x = 0) {
  const std::string at = std::to_string(x);
  return "  - {type: triangle, v0: [" + at + ", 0, 0], v1: [" + at + ", 1, 0], v2: [" + at + ", 0, 1], " + more + "}\n";
}

const std::string kNormals = "n0: [1, 0, 0], n1: [0, 1, 0], n2: [0, 0, 2]";

TEST(YamlScene, TrianglesThatFollowEachOtherBecomeOneMesh) {
  const SceneDescription scene = parse(
      kMaterials + "geometry:\n" + triangle("material: m", 1) + triangle("material: n", 2) +
      triangle("material: m, visible: false", 3) + triangle("material: n, visible: false", 4) +
      "  - {type: sphere, material: m, center: [0, 0, 0], radius: 1}\n" + triangle("material: n, visible: true", 5));
  ASSERT_EQ(scene.objects.size(), 4U);
  const auto& first = std::get<Mesh>(scene.objects[0].shape);
  EXPECT_EQ(first.vertices, (std::vector<Vec3f>{{1, 0, 0}, {1, 1, 0}, {1, 0, 1}, {2, 0, 0}, {2, 1, 0}, {2, 0, 1}}));
  EXPECT_EQ(first.triangles, (std::vector<Mesh::Corners>{{0, 1, 2}, {3, 4, 5}}));
  EXPECT_EQ(first.materials, (std::vector<uint32_t>{0, 1}));
  EXPECT_TRUE(first.normals.empty() && first.normal_corners.empty());
  EXPECT_TRUE(scene.objects[0].visible);
  EXPECT_FALSE(scene.objects[1].visible);
  EXPECT_EQ(std::get<Mesh>(scene.objects[1].shape).triangles.size(), 2U);
  EXPECT_EQ(scene.objects[1].place, "t.yaml:8:5");
  EXPECT_EQ(std::get<Mesh>(scene.objects[3].shape).materials, (std::vector<uint32_t>{1}));
}

TEST(YamlScene, NormalsOfTrianglesGoWithTheirCorners) {
  const std::string with = triangle("material: m, " + kNormals), without = triangle("material: m");
  const auto mesh_of = [](const std::string& triangles) {
    return std::get<Mesh>(parse(kMaterials + "geometry:\n" + triangles).objects.at(0).shape);
  };
  const Mesh::Corners none = {kNone, kNone, kNone};
  const std::vector<Vec3f> three = {{1, 0, 0}, {0, 1, 0}, {0, 0, 2}};
  EXPECT_EQ(mesh_of(with).normals, three);
  EXPECT_TRUE(mesh_of(with + with).normal_corners.empty()) << "as the triangles' own corners";
  EXPECT_EQ(mesh_of(with + with).normals.size(), 6U);
  EXPECT_EQ(mesh_of(without + with + without).normals, three);
  EXPECT_EQ(mesh_of(without + with + without).normal_corners, (std::vector<Mesh::Corners>{none, {0, 1, 2}, none}));
  EXPECT_EQ(mesh_of(with + with + without + with).normal_corners,
            (std::vector<Mesh::Corners>{{0, 1, 2}, {3, 4, 5}, none, {6, 7, 8}}));
}

TEST(YamlScene, TrianglesWithoutAreaAreNotedTogether) {
  const std::string flat = "  - {type: triangle, material: m, v0: [1, 1, 1], v1: [2, 2, 2], v2: [3, 3, 3]}\n";
  const SceneDescription scene = parse(kMaterials + "geometry:\n" + flat + flat + flat);
  EXPECT_EQ(scene.notes, (std::vector<std::string>{"a triangle without area is never hit (t.yaml:6:5 and 2 more)"}));
  EXPECT_EQ(std::get<Mesh>(scene.objects.at(0).shape).triangles.size(), 3U);
}

TEST(YamlScene, AliasesStandForTheirAnchors) {
  const SceneDescription scene = parse(
      "camera: {position: &p [1, 2, 3], look_at: [0, 0, 0]}\n"
      "materials: [&m {name: &name m, albedo: &half [0.5, 0.5, 0.5]}, {name: n, albedo: *half}]\n"
      "geometry:\n  - {type: sphere, material: *name, center: *p, radius: 1}\n  - &s {type: sphere, material: n, "
      "center: *p, radius: 2}\n  - *s\n");
  EXPECT_EQ(scene.materials.at(1).albedo, (Vec3f{0.5F, 0.5F, 0.5F}));
  ASSERT_EQ(scene.objects.size(), 3U);
  EXPECT_EQ(std::get<Sphere>(scene.objects[2].shape).center, (Vec3f{1, 2, 3}));
  EXPECT_EQ(std::get<Sphere>(scene.objects[2].shape).radius, 2);
  EXPECT_EQ(scene.objects[2].place, "t.yaml:6:5") << "of the alias";
}

TEST(YamlScene, WhatYamlAllowsOfTextsIsRight) {
  const auto name_of = [](const std::string& value) { return parse("%YAML 1.2\n---\nscene:\n  name: " + value).name; };
  EXPECT_EQ(name_of("it's a \"room\" # two"), "it's a \"room\"");
  EXPECT_EQ(name_of("'it''s'\n"), "it's");
  EXPECT_EQ(name_of("\"a\\\"\\\\\""), "a\"\\");
  EXPECT_EQ(name_of("&a # '\n    ! b"), "b");
  EXPECT_EQ(name_of("|\n    it's\n    \"two\n"), "it's\n\"two\n");
  EXPECT_EQ(name_of(">-\n    one\n    [two\n...\n"), "one [two");
  EXPECT_EQ(name_of("one\n    two"), "one two");
  EXPECT_EQ(name_of("12"), "12");
}

TEST(YamlScene, ReadsAFileRelativeToItsOwnFolderAndWindowsTextToo) {
  const Folder folder;
  std::filesystem::create_directory(folder.path("models"));
  folder.write("models/small.ply", small_ply());
  const std::string text = "\xEF\xBB\xBFgeometry:\r\n  - type: obj\r\n    file: models/../models/small.ply\r\n";
  const SceneDescription scene = read_yaml_scene(folder.write("room.yaml", text));
  ASSERT_EQ(scene.objects.size(), 1U);
  EXPECT_EQ(std::get<Mesh>(scene.objects[0].shape).triangles.size(), 3U);
  EXPECT_EQ(scene.objects[0].place, folder.path("room.yaml") + ":2:5");
  const SceneDescription absolute =
      parse("geometry: [{type: obj, filename: '" + folder.path("models/small.ply") + "'}]", "/nowhere");
  EXPECT_EQ(std::get<Mesh>(absolute.objects.at(0).shape).triangles.size(), 3U);
}

/// The texts between "```yaml" and "```".
std::vector<std::string> examples_in(const std::string& page) {
  std::vector<std::string> found;
  for (size_t at = page.find("```yaml\n"); at != std::string::npos; at = page.find("```yaml\n", at)) {
    at += 8;
    found.push_back(page.substr(at, page.find("```", at) - at));
  }
  return found;
}

TEST(YamlScene, TheExamplesOfTheReferenceLoadWithoutANote) {
  const Folder folder;
  folder.write("chair.ply", small_ply());
  const std::string page = content_of(std::string(KERF_DOCS) + "/scenes.md");
  const std::vector<std::string> examples = examples_in(page);
  EXPECT_GE(examples.size(), 3U);
  for (const std::string& example : examples) {
    SCOPED_TRACE(example);
    const SceneDescription scene = read_yaml_scene(folder.write("example.yaml", example));
    EXPECT_FALSE(scene.objects.empty());
    EXPECT_TRUE(scene.notes.empty());
  }
}

TEST(YamlScene, TheReferenceNamesEveryKeyThatAnErrorNames) {
  const std::string page = content_of(std::string(KERF_DOCS) + "/scenes.md");
  // What is near to nothing makes the error list what there is.
  const std::string odd = "qqqqqqqqqqqqqqqqqqqqqqqq: 1";
  const std::string sphere = "type: sphere, ", rectangle = "type: rectangle, ", triangle_type = "type: triangle, ";
  for (const std::string& text :
       {odd, "camera: {" + odd + "}", "settings: {" + odd + "}", "scene: {" + odd + "}", with_material(odd),
        with_item(sphere + odd), with_item(rectangle + odd), with_item(triangle_type + odd),
        with_item("type: obj, " + odd), with_material("type: qqqqqqqqqqqqqqqqqqqqqqqq"),
        with_item("type: qqqqqqqqqqqqqqqqqqqqqqqq")}) {
    SCOPED_TRACE(text);
    const std::string what = error_of(text);
    const size_t list = what.find("; expected ");
    ASSERT_NE(list, std::string::npos) << what;
    const std::string words = what.substr(list + 11);
    const std::regex word("[a-z_0-9]+");
    for (std::sregex_iterator i(words.begin(), words.end(), word), end; i != end; ++i) {
      if (i->str() == "or") continue;
      EXPECT_NE(page.find("`" + i->str() + "`"), std::string::npos) << i->str();
    }
  }
}

}  // namespace
}  // namespace kerf::test
