// Models that a YAML scene places, and scenes made at random.

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "kerf/io/model.h"
#include "support/error_of.h"
#include "support/folder.h"
#include "yaml_text.h"

namespace kerf::test {
namespace {

const Mesh& mesh_of(const SceneDescription& scene, size_t object = 0) {
  return std::get<Mesh>(scene.objects.at(object).shape);
}

/// The scene of small.ply with these keys.
SceneDescription placed(const std::string& keys) {
  const Folder folder;
  folder.write("small.ply", small_ply());
  return parse(kMaterials + "geometry:\n  - {type: obj, file: small.ply" + keys + "}\n", folder.path(""));
}

TEST(YamlModels, AreScaledThenMoved) {
  const SceneDescription plain = placed("");
  EXPECT_EQ(mesh_of(plain).triangles, (std::vector<Mesh::Corners>{{0, 1, 2}, {0, 2, 3}, {3, 2, 4}}));
  const SceneDescription moved = placed(", position: [10, 0.1, -1], scale: [2, 3, 0.1]");
  const SceneDescription half = placed(", scale: 0.5");
  for (size_t i = 0; i < mesh_of(plain).vertices.size(); ++i) {
    const Vec3d p = to_double(mesh_of(plain).vertices[i]);
    EXPECT_EQ(mesh_of(moved).vertices[i], to_float({p.x * 2 + 10, p.y * 3 + 0.1, p.z * 0.1 - 1}));
    EXPECT_EQ(mesh_of(half).vertices[i], to_float(p * 0.5));
  }
  EXPECT_EQ(mesh_of(moved).triangles, mesh_of(plain).triangles);
  EXPECT_FALSE(placed(", visible: false").objects[0].visible);
}

/// The normal of a triangle as its corners turn.
Vec3d facing(const Mesh& mesh, size_t i) {
  const Mesh::Corners& k = mesh.triangles[i];
  const auto vertex = [&](size_t corner) { return to_double(mesh.vertices[k[corner]]); };
  return cross(vertex(1) - vertex(0), vertex(2) - vertex(0));
}

TEST(YamlModels, MirroredOnesKeepTheirOutsideOut) {
  const SceneDescription plain = placed("");
  for (const std::string scale : {"[-1, 1, 1]", "[1, -2, 1]", "[1, 1, -1]", "-1", "[-1, -1, 1]", "[-1, 3, -1]"}) {
    SCOPED_TRACE(scale);
    const SceneDescription scene = placed(", scale: " + scale);
    const Vec3d s = to_double(mesh_of(placed(", position: [1, 1, 1], scale: " + scale)).vertices[2]);
    const bool negative_z = scale.find("-1]") != std::string::npos || scale == "-1";
    // The square lies in z = 0 and faces +z; its image faces that way's image.
    EXPECT_GT(facing(mesh_of(plain), 0).z, 0);
    EXPECT_GT(facing(mesh_of(scene), 0).z * (negative_z ? -1 : 1), 0) << s.x;
  }
}

TEST(YamlModels, NormalsStayUprightOnTheirSurface) {
  const Folder folder;
  // A slope of 45 degrees and its normal.
  folder.write("slope.obj", "v 0 0 0\nv 1 1 0\nv 0 0 -1\nvn -1 1 0\nf 1//1 2//1 3//1\n");
  const auto with_scale = [&](const std::string& scale) {
    return parse("geometry: [{type: obj, file: slope.obj, scale: " + scale + "}]", folder.path(""));
  };
  for (const std::string scale : {"1", "3", "[1, 2, 1]", "[-1, 2, 5]", "-2", "[1e30, 1, 1]", "[1e-30, 1e30, 1]"}) {
    SCOPED_TRACE(scale);
    const SceneDescription scene = with_scale(scale);
    const Mesh& mesh = mesh_of(scene);
    ASSERT_EQ(mesh.normals.size(), mesh.normal_corners.empty() ? 3U : 1U);
    const Vec3d normal = to_double(mesh.normals[0]);
    const Vec3d flat = facing(mesh, 0);
    const double size = std::sqrt(dot(flat, flat)) * std::sqrt(dot(normal, normal));
    EXPECT_NEAR(dot(flat, normal) / size, 1, 1e-6) << "the same side, upright";
  }
}

TEST(YamlModels, NormalsAndTextureCoordinatesGoWithTheirCornersThroughAMirror) {
  const Folder folder;
  folder.write("one.obj",
               "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nvn 0 1 0\nvn 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\n"
               "f 1/3/2 2/1/3 3/2/1\n");
  const auto corners_of = [&](const std::string& scale) {
    const SceneDescription scene =
        parse("geometry: [{type: obj, file: one.obj, scale: " + scale + "}]", folder.path(""));
    const Mesh& mesh = mesh_of(scene);
    const Mesh::Corners& normals = (mesh.normal_corners.empty() ? mesh.triangles : mesh.normal_corners)[0];
    const Mesh::Corners& uvs = (mesh.uv_corners.empty() ? mesh.triangles : mesh.uv_corners)[0];
    std::map<uint32_t, std::pair<Vec3f, std::array<float, 2>>> corners;  // by vertex
    for (size_t i = 0; i < 3; ++i) {
      corners[mesh.triangles[0][i]] = {abs(mesh.normals.at(normals[i])), mesh.uvs.at(uvs[i])};
    }
    return corners;
  };
  EXPECT_EQ(corners_of("1").size(), 3U);
  EXPECT_EQ(corners_of("1"), corners_of("[1, 1, -1]"));
}

TEST(YamlModels, TakeTheSceneMaterialOrTheirOwn) {
  const Folder folder;
  folder.write("small.ply", small_ply());
  folder.write("two.mtl", "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n");
  folder.write("two.obj", "mtllib two.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl blue\nf 1 2 3\nusemtl red\nf 1 3 2\n");
  const SceneDescription scene = parse(kMaterials +
                                           "geometry:\n  - {type: obj, file: small.ply}\n"
                                           "  - {type: obj, file: two.obj, material: n}\n"
                                           "  - {type: obj, file: two.obj}\n"
                                           "  - {type: obj, file: small.ply, material: m}\n"
                                           "  - {type: obj, file: ./two.obj, position: [5, 0, 0]}\n"
                                           "  - {type: obj, file: small.ply, scale: 2}\n",
                                       folder.path(""));
  ASSERT_EQ(scene.objects.size(), 6U);
  ASSERT_EQ(scene.materials.size(), 5U) << "two of the scene, the default, two of two.obj once";
  const auto material_of = [&](size_t object, size_t triangle) {
    const Mesh& mesh = mesh_of(scene, object);
    return scene.materials[mesh.materials.empty() ? scene.objects[object].material : mesh.materials.at(triangle)];
  };
  EXPECT_EQ(material_of(0, 0).albedo, Material{}.albedo);
  EXPECT_EQ(material_of(1, 0).name, "n");
  EXPECT_TRUE(mesh_of(scene, 1).materials.empty());
  for (const size_t object : {2U, 4U}) {
    EXPECT_EQ(material_of(object, 0).name, "blue");
    EXPECT_EQ(material_of(object, 1).name, "red");
  }
  EXPECT_EQ(material_of(3, 0).name, "m");
  EXPECT_EQ(scene.objects[5].material, scene.objects[0].material);
  EXPECT_EQ(mesh_of(scene, 4).vertices[1], (Vec3f{6, 0, 0}));
  EXPECT_EQ(mesh_of(scene, 2).vertices[1], (Vec3f{1, 0, 0}));
  EXPECT_EQ(mesh_of(scene, 5).vertices[1], (Vec3f{2, 0, 0}));
}

TEST(YamlModels, TheirTexturesAreNumberedInTheScene) {
  const Folder folder;
  // Two TGA images of one pixel, blue-green-red.
  const std::string header = std::string("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\x18\0", 18);
  folder.write("a.tga", header + "\x01\x02\x03");
  folder.write("b.tga", header + "\x04\x05\x06");
  for (const std::string name : {"a", "b"}) {
    folder.write(name + ".mtl", "newmtl skin\nmap_Kd " + name + ".tga\n");
    folder.write(name + ".obj", "mtllib " + name + ".mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl skin\nf 1 2 3\n");
  }
  const SceneDescription scene =
      parse("geometry: [{type: obj, file: a.obj}, {type: obj, file: b.obj}]", folder.path(""));
  ASSERT_EQ(scene.textures.size(), 2U);
  const auto texel = [&](size_t object) {
    return scene.textures.at(scene.materials.at(mesh_of(scene, object).materials.at(0)).albedo_texture).rgb.at(0);
  };
  EXPECT_EQ(texel(0), 3);
  EXPECT_EQ(texel(1), 6);
}

TEST(YamlModels, ErrorsInThemStandBehindThePlaceInTheScene) {
  const Folder folder;
  folder.write("bad.ply", "ply\nformat ascii 1.0\nelement vertex 1\nend_header\n");
  folder.write("empty.ply",
               "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n"
               "end_header\n");
  folder.write("small.ply", small_ply());
  const auto what = [&](const std::string& keys) {
    return error_of("geometry:\n  - type: obj\n    " + keys + "\n", folder.path(""));
  };
  for (const std::string name : {"bad.ply", "none.ply", "model.plx"}) {
    const std::string own = error_of(ErrorCode::file, [&] { read_model(folder.path(name)); });
    EXPECT_TRUE(own.starts_with(folder.path(name))) << own;
    EXPECT_EQ(what("file: " + name), "t.yaml:3:11: " + own);
  }
  EXPECT_EQ(what("file: empty.ply"), "t.yaml:3:11: " + folder.path("empty.ply") + " has no face, so nothing to see");
  EXPECT_EQ(what("file: small.ply\n    position: [1e36, 0, 0]\n    scale: 1e36"),
            "t.yaml:3:11: scale and position move vertex 1 beyond 2^120 (1.3e36)");
  EXPECT_EQ(what("file: none.ply\n    visible: 3").substr(0, 13), "t.yaml:4:14: ") << "the text comes first";
}

TEST(YamlModels, NotesOfAModelHaveThePlace) {
  const Folder folder;
  folder.write("odd.mtl", "newmtl skin\nKd 1 0 0\nillum 2\nbump nowhere.png\n");
  folder.write("odd.obj", "mtllib odd.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl skin\nf 1 2 3\nl 1 2\n");
  const Model model = read_model(folder.path("odd.obj"));
  const SceneDescription scene =
      parse("geometry: [{type: obj, file: odd.obj}, {type: obj, file: odd.obj}]", folder.path(""));
  ASSERT_EQ(scene.notes.size(), model.notes.size()) << "once, for it is read once";
  EXPECT_FALSE(model.notes.empty());
  for (size_t i = 0; i < model.notes.size(); ++i) {
    EXPECT_EQ(scene.notes[i], "t.yaml:1:30: " + folder.path("odd.obj") + ": " + model.notes[i]);
  }
}

}  // namespace
}  // namespace kerf::test
