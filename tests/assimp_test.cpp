// What is read with Assimp: small files by hand, and all of its own test models where they are installed.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "kerf/io/assimp_model.h"
#include "kerf/io/image_write.h"
#include "kerf/io/model.h"
#include "support/error_of.h"
#include "support/folder.h"

// Some of Assimp's readers lose memory over files that they refuse; that is not ours to find here.
extern "C" const char* __lsan_default_suppressions() { return "leak:libassimp\n"; }  // NOLINT

namespace kerf::test {
namespace {

using Points = std::vector<Vec3f>;

/// A COLLADA file with one triangle, a mesh of which stands in the scene as `nodes` says ("<node>...</node>").
std::string collada(const std::string& nodes,
                    const std::string& effect = "<diffuse><color>1 0.5 0.25 1</color></diffuse>",
                    const std::string& more = "", const std::string& up = "Y_UP") {
  return R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="1"/><up_axis>)" +
         up + "</up_axis></asset>" + more + R"(
<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert>)" +
         effect + R"(</lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m" name="paint"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 1 0</float_array><technique_common>
<accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<source id="n"><float_array id="na" count="9">0 0 1 0 0 1 0 0 1</float_array><technique_common>
<accessor source="#na" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<source id="t"><float_array id="ta" count="6">0 0 1 0 0 0.5</float_array><technique_common>
<accessor source="#ta" count="3" stride="2"><param name="S" type="float"/><param name="T" type="float"/>
</accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1" material="s"><input semantic="VERTEX" source="#v" offset="0"/>
<input semantic="NORMAL" source="#n" offset="0"/><input semantic="TEXCOORD" source="#t" offset="0"/>
<p>0 1 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="vs">)" +
         nodes + R"(</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#vs"/></scene></COLLADA>)";
}

const std::string kInstance =
    R"(<instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="s" target="#m"/>)"
    "</technique_common></bind_material></instance_geometry>";

Model read_text(const std::string& name, const std::string& text) {
  const Folder folder;
  return read_with_assimp(folder.write(name, text));
}

std::string refusal(const std::string& name, const std::string& text) {
  const Folder folder;
  const std::string path = folder.write(name, text);
  const std::string what = error_of(ErrorCode::file, [&] { read_with_assimp(path); });
  EXPECT_TRUE(what.starts_with(path + ": ")) << what;
  return what.substr(std::min(what.size(), path.size() + 2));
}

/// The corners of each triangle, one after the other.
Points corners_of(const Mesh& mesh) {
  Points corners;
  for (const Mesh::Corners& triangle : mesh.triangles) {
    for (const uint32_t corner : triangle) corners.push_back(mesh.vertices.at(corner));
  }
  return corners;
}

void expect_near(const Points& found, const Points& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (size_t i = 0; i < found.size(); ++i) EXPECT_LT(largest(abs(found[i] - expected[i])), 1e-5F) << i;
}

TEST(Assimp, NodesPlaceWhatHangsFromThem) {
  const std::string inner = "<node><rotate>0 0 1 90</rotate>" + kInstance + "</node>";
  const Model model = read_text(
      "a.dae", collada("<node><translate>10 0 0</translate><scale>2 2 2</scale>" + kInstance + inner + "</node>"));
  expect_near(corners_of(model.mesh), {{10, 0, 0}, {12, 0, 0}, {10, 2, 0}, {10, 0, 0}, {10, 2, 0}, {8, 0, 0}});
  EXPECT_EQ(model.mesh.normals.size(), model.mesh.vertices.size());
  EXPECT_TRUE(model.mesh.normal_corners.empty() && model.mesh.uv_corners.empty());
  for (const Vec3f& normal : model.mesh.normals) EXPECT_LT(largest(abs(normal - Vec3f{0, 0, 1})), 1e-5F);
  // A file in which z is up is turned.
  const Model turned = read_text("a.dae", collada("<node>" + kInstance + "</node>", "", "", "Z_UP"));
  expect_near(corners_of(turned.mesh), {{0, 0, 0}, {1, 0, 0}, {0, 0, -1}});
}

TEST(Assimp, MirroredTrianglesAreTurnedSoThatTheyStayCounterClockwise) {
  const Model model = read_text("a.dae", collada("<node><scale>-1 1 1</scale>" + kInstance + "</node>"));
  const Points p = corners_of(model.mesh);
  ASSERT_EQ(p.size(), 3U);
  EXPECT_GT(cross(p[1] - p[0], p[2] - p[0]).z, 0);
  EXPECT_EQ(std::count(p.begin(), p.end(), Vec3f{-1, 0, 0}), 1);
}

TEST(Assimp, MaterialsHaveTheirColours) {
  const Model model = read_text("a.dae", collada("<node>" + kInstance + "</node>",
                                                 "<emission><color>0 2 0 1</color></emission>"
                                                 "<diffuse><color>1 0.5 0.25 1</color></diffuse>"));
  ASSERT_EQ(model.mesh.materials.size(), 1U);
  const Material& material = model.materials.at(model.mesh.materials[0]);
  EXPECT_EQ(material.name, "paint");
  EXPECT_EQ(material.type, MaterialType::lambertian);
  EXPECT_EQ(material.albedo, (Vec3f{1, 0.5F, 0.25F}));
  EXPECT_EQ(material.emission, (Vec3f{0, 2, 0}));
  const Model clear = read_text("a.dae", collada("<node>" + kInstance + "</node>",
                                                 "<transparency><float>0.25</float></transparency>"
                                                 "<index_of_refraction><float>1.5</float></index_of_refraction>"));
  const Material& glass = clear.materials.at(clear.mesh.materials.at(0));
  EXPECT_EQ(glass.type, MaterialType::glass);
  EXPECT_EQ(glass.transmission, 0.75F);
  EXPECT_EQ(glass.refractive_index, 1.5F);
}

TEST(Assimp, TexturesStandBesideTheFileOrAreLeftOutWithANote) {
  const Folder folder;
  write_png(folder.path("Red.png"), {1, 1, 3, {1, 0, 0}});
  const auto read_texture_named = [&](const std::string& name) {
    const std::string effect =
        R"(<diffuse><texture texture="i" texcoord="UV"/></diffuse></lambert></technique></profile_COMMON>)"
        "</effect><effect id=\"unused\"><profile_COMMON><technique sid=\"t\"><lambert>";
    const std::string images =
        "<library_images><image id=\"i\"><init_from>" + name + "</init_from></image></library_images>";
    return read_with_assimp(folder.write("a.dae", collada("<node>" + kInstance + "</node>", effect, images)));
  };
  for (const char* name : {"Red.png", "red.PNG", "C:\\pictures\\Red.png", "sub/Red.png"}) {
    const Model model = read_texture_named(name);
    EXPECT_TRUE(model.notes.empty()) << name;
    ASSERT_EQ(model.textures.size(), 1U) << name;
    EXPECT_EQ(model.textures[0].rgb, (std::vector<uint8_t>{255, 0, 0}));
    EXPECT_EQ(model.materials.at(model.mesh.materials.at(0)).albedo_texture, 0U);
    EXPECT_EQ(model.mesh.uvs.size(), model.mesh.vertices.size());
    const uint32_t last = model.mesh.triangles.at(0)[2];
    EXPECT_EQ(model.mesh.uvs.at(last), (std::array<float, 2>{0, 0.5F}));
  }
  folder.write("none.png", "no image");
  for (const char* name : {"none.png", "missing.png"}) {
    const Model model = read_texture_named(name);
    EXPECT_TRUE(model.textures.empty());
    EXPECT_EQ(model.materials.at(model.mesh.materials.at(0)).albedo_texture, kNoTexture);
    ASSERT_EQ(model.notes.size(), 1U);
    EXPECT_TRUE(model.notes[0].starts_with(std::string("a texture is left out: '") + name + "': ")) << model.notes[0];
  }
}

TEST(Assimp, TheCameraIsWhereItsNodeIs) {
  const std::string camera =
      R"(<library_cameras><camera id="c" name="c"><optics><technique_common><perspective><yfov>40</yfov>)"
      "<aspect_ratio>1.5</aspect_ratio><znear>0.1</znear><zfar>100</zfar></perspective></technique_common></optics>"
      "</camera></library_cameras>";
  const Model model = read_text(
      "a.dae", collada(R"(<node id="k" name="k"><translate>1 2 3</translate><instance_camera url="#c"/></node><node>)" +
                           kInstance + "</node>",
                       "", camera));
  ASSERT_TRUE(model.camera);
  EXPECT_LT(largest(abs(model.camera->eye - Vec3d{1, 2, 3})), 1e-6);
  EXPECT_LT(largest(abs(model.camera->look_at - Vec3d{1, 2, 2})), 1e-6);
  EXPECT_LT(largest(abs(model.camera->up - Vec3d{0, 1, 0})), 1e-6);
  EXPECT_NEAR(model.camera->fov, 40, 1e-3);
}

TEST(Assimp, PolygonsAreCutAndPointsAndLinesLeftOut) {
  const Model model = read_text("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nl 1 2\np 3\n");
  EXPECT_EQ(model.mesh.triangles.size(), 2U);
  EXPECT_EQ(model.mesh.vertices.size(), 4U);  // joined
  EXPECT_EQ(model.notes, (std::vector<std::string>{"points and lines are left out"}));
  EXPECT_EQ(read_text("a.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n").mesh.triangles.size(), 2U);
}

TEST(Assimp, WhatCannotBeReadIsRefused) {
  EXPECT_EQ(error_of(ErrorCode::file, [] { read_with_assimp("no/such.fbx"); }), "no/such.fbx: there is no such file");
  EXPECT_TRUE(refusal("a.dae", "no xml").starts_with("cannot be read by Assimp: "));
  EXPECT_TRUE(refusal("a.fbx", "").starts_with("cannot be read by Assimp: "));
  EXPECT_EQ(refusal("a.off", "OFF # a comment\n353535235358 6 0\n0 0 0\n"),
            "counts 353535235358 vertices or faces, and has 39 bytes");
  EXPECT_EQ(
      refusal("a.stp", "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\n"),
      "is a STEP file of schema 'AUTOMOTIVE_DESIGN', a part with curved surfaces (B-rep), which cannot be read; save "
      "it as triangles, such as STL or glTF");
  EXPECT_TRUE(refusal("a.ifc", "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('IFC2X3'));\nENDSEC;\n")
                  .starts_with("cannot be read by Assimp: "));
}

/// A zip archive of one file, stored as it is, with a wrong check sum.
std::string broken_zip(const std::string& name, const std::string& content) {
  const auto number = [](size_t value, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i) & 0xFF);
    return text;
  };
  const std::string sizes = number(1, 4) + number(content.size(), 4) + number(content.size(), 4);
  const std::string about = number(10, 2) + number(0, 2) + number(0, 2) + number(0, 4) + sizes;
  const std::string local = "PK\3\4" + about + number(name.size(), 2) + number(0, 2) + name + content;
  const std::string central = "PK\1\2" + number(10, 2) + about + number(name.size(), 2) + std::string(16, '\0') + name;
  return local + central + "PK\5\6" + number(0, 4) + number(1, 2) + number(1, 2) + number(central.size(), 4) +
         number(local.size(), 4) + number(0, 2);
}

TEST(Assimp, AnAssertionOfAssimpThatFailsIsAnError) {
  const std::string rels =
      R"(<?xml version="1.0"?><Relationships><Relationship Target="/3D/a.model" Id="r" Type="t"/></Relationships>)";
  EXPECT_TRUE(refusal("a.3mf", broken_zip("_rels/.rels", rels)).starts_with("cannot be read by Assimp: "));
}

TEST(Assimp, ExtensionsAreInOrderAndKnownToReadModel) {
  const std::vector<std::string> extensions = assimp_extensions();
  EXPECT_TRUE(std::is_sorted(extensions.begin(), extensions.end()));
  EXPECT_TRUE(std::adjacent_find(extensions.begin(), extensions.end()) == extensions.end());
  for (const char* known : {".fbx", ".dae", ".3ds", ".ifc", ".x3d", ".off"}) {
    EXPECT_TRUE(std::binary_search(extensions.begin(), extensions.end(), known)) << known;
  }
  for (const std::string& extension : extensions) EXPECT_TRUE(extension.size() > 1 && extension[0] == '.');
  const std::vector<std::string> all = model_extensions();
  EXPECT_NE(std::find(all.begin(), all.end(), ".fbx"), all.end());
  EXPECT_EQ(std::count(all.begin(), all.end(), ".ply"), 1);
  const Folder folder;
  const std::string path = folder.write("A.OFF", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n");
  EXPECT_EQ(read_model(path).mesh.triangles.size(), 1U);
}

#ifdef KERF_ASSIMP_MODELS
constexpr const char* kModels = KERF_ASSIMP_MODELS;
#else
constexpr const char* kModels = "";
#endif

/// The files below a folder of Assimp's test models, in order.
std::vector<std::string> test_models(const std::string& folder) {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kModels + folder)) {
    if (entry.is_regular_file()) paths.push_back(entry.path().string());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// A model that keeps what it promises, or nothing for an Error.
template <class Read>
std::optional<Model> try_to_read(const std::string& path, Read&& read) {
  SCOPED_TRACE(path);
  std::optional<Model> model;
  try {
    model = read(path);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::file) << error.what();
    EXPECT_EQ(error.place(), path);
    return {};
  }
  const Mesh& mesh = model->mesh;
  const auto in_range = [&](const std::vector<Mesh::Corners>& corners, size_t count) {
    return std::all_of(corners.begin(), corners.end(), [&](const Mesh::Corners& triangle) {
      return std::all_of(triangle.begin(), triangle.end(), [&](uint32_t corner) {
        return corner < count || (&corners != &mesh.triangles && ~corner == 0);
      });
    });
  };
  EXPECT_TRUE(in_range(mesh.triangles, mesh.vertices.size()));
  EXPECT_TRUE(in_range(mesh.normal_corners, mesh.normals.size()));
  EXPECT_TRUE(in_range(mesh.uv_corners, mesh.uvs.size()));
  EXPECT_TRUE(mesh.normals.empty() || !mesh.normal_corners.empty() || mesh.normals.size() == mesh.vertices.size());
  EXPECT_TRUE(mesh.uvs.empty() || !mesh.uv_corners.empty() || mesh.uvs.size() == mesh.vertices.size());
  EXPECT_TRUE(mesh.materials.empty() || mesh.materials.size() == mesh.triangles.size());
  for (const uint32_t material : mesh.materials) EXPECT_LT(material, model->materials.size());
  for (const Material& material : model->materials) {
    EXPECT_TRUE(material.albedo_texture == kNoTexture || material.albedo_texture < model->textures.size());
  }
  return model;
}

TEST(AssimpModels, EveryFileIsAModelOrAnError) {
  if (*kModels == '\0') GTEST_SKIP() << "Assimp's test models are not installed";
  size_t models = 0, errors = 0;
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  for (const std::string& path : test_models("")) {
    const std::string end = std::filesystem::path(path).extension().string();
    if (end == ".png" || end == ".jpg" || end == ".bin") continue;
    const bool is_model = try_to_read(path, read_with_assimp).has_value();
    ++(is_model ? models : errors);
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_GT(models, 300U);
  EXPECT_GT(errors, 10U);
}

TEST(AssimpModels, EveryFileOfAFormatOfOurOwnIsAModelOrAnError) {
  if (*kModels == '\0') GTEST_SKIP() << "Assimp's test models are not installed";
  size_t models = 0;
  for (const std::string& path : test_models("")) {
    const std::string end = std::filesystem::path(path).extension().string();
    const char* const own[] = {".gltf", ".glb"};
    if (std::find(std::begin(own), std::end(own), end) == std::end(own)) continue;
    if (try_to_read(path, read_model)) ++models;
  }
  EXPECT_GT(models, 20U);
}

struct Bounds {
  Vec3f low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
};

Bounds bounds_of(const Mesh& mesh) {
  Bounds bounds;
  for (const Vec3f& corner : corners_of(mesh)) {
    bounds.low = min(bounds.low, corner);
    bounds.high = max(bounds.high, corner);
  }
  return bounds;
}

TEST(AssimpModels, OurReaderOfGltfFindsTheSameTriangles) {
  if (*kModels == '\0') GTEST_SKIP() << "Assimp's test models are not installed";
  size_t compared = 0;
  for (const std::string& path : test_models("/glTF2")) {
    if (!path.ends_with(".gltf") && !path.ends_with(".glb")) continue;
    if (path.find("Infinites") != std::string::npos) continue;  // has no bounds
    const std::optional<Model> ours = try_to_read(path, read_model), theirs = try_to_read(path, read_with_assimp);
    if (!ours || !theirs) continue;
    SCOPED_TRACE(path);
    ++compared;
    ASSERT_EQ(ours->mesh.triangles.size(), theirs->mesh.triangles.size());
    if (ours->mesh.triangles.empty()) continue;
    const Bounds a = bounds_of(ours->mesh), b = bounds_of(theirs->mesh);
    const float tolerance = 1e-5F * largest(a.high - a.low);  // they place by floats, we by doubles
    EXPECT_LT(largest(abs(a.low - b.low)), tolerance);
    EXPECT_LT(largest(abs(a.high - b.high)), tolerance);
  }
  EXPECT_GT(compared, 20U);
}

}  // namespace
}  // namespace kerf::test
