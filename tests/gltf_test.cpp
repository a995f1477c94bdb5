// glTF: where the triangles are. What they look like is in gltf_material_test.cpp.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "gltf_text.h"
#include "support/error_of.h"

namespace kerf::test {
namespace {

void expect_triangle(const Model& model) {
  EXPECT_EQ(model.mesh.vertices, (Points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(model.mesh.triangles, (Triangles{{0, 1, 2}}));
  EXPECT_TRUE(model.mesh.normals.empty() && model.mesh.uvs.empty() && model.mesh.materials.empty());
  EXPECT_TRUE(model.materials.empty() && model.textures.empty() && !model.camera);
  EXPECT_TRUE(model.notes.empty());
}

TEST(Gltf, ReadsBuffersInTheTextBesideItAndInTheBinaryChunk) {
  const Folder folder;
  const GltfMaker gltf = triangle();
  expect_triangle(read(folder, gltf.embedded()));
  expect_triangle(read(folder, gltf.glb()));  // by what it holds, whatever its name
  expect_triangle(read(folder, "\xEF\xBB\xBF" + gltf.embedded()));
  std::filesystem::create_directory(folder.path("sub"));
  for (const auto& [name, uri] : {std::pair{"data.bin", "data.bin"},
                                  {"a b.bin", "a%20b.bin"},
                                  {"a+b.bin", "a+b.bin"},
                                  {"\xC3\xA4.bin", "\\u00e4.bin"},
                                  {"sub/d.bin", "sub\\/d.bin"},
                                  {"e.bin", "sub/../e.bin"}}) {
    folder.write(name, gltf.binary + "more than the file says");
    expect_triangle(read(folder, gltf.json(uri)));
  }
  std::string escaped;
  for (const char c : gltf.embedded()) escaped += c == '/' ? "\\/" : std::string(1, c);
  expect_triangle(read(folder, escaped));
  EXPECT_EQ(refusal(folder, gltf.json("none.bin")), "buffers[0] is at 'none.bin': there is no such file");
  EXPECT_EQ(refusal(folder, gltf.json("sub")), "buffers[0] is at 'sub', which is not a regular file");
  EXPECT_EQ(refusal(folder, gltf.json("/dev/zero")), "buffers[0] is at '/dev/zero', which is not a regular file");
  EXPECT_EQ(refusal(folder, gltf.json("http://a/b")),
            "buffers[0] is at 'http://a/b'; only files and data: URIs can be read");
  EXPECT_EQ(refusal(folder, gltf.json("data:;base64,????")), "buffers[0] has a data: URI with what is not base64");
  EXPECT_EQ(refusal(folder, gltf.json("data:,AAAA")), "buffers[0] has a data: URI that is not in base64");
  EXPECT_EQ(refusal(folder, gltf.json("data:;base64,AAAA")), "buffers[0] has 3 bytes; its byteLength is 36");
  EXPECT_EQ(refusal(folder, gltf.json("")), "buffers[0] has no uri, and there is no binary chunk for it");
}

template <class T>
void expect_indices() {
  SCOPED_TRACE(component_type<T>());
  GltfMaker gltf;
  gltf.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, 3);
  gltf.accessor<T>({0, 1, 2, 2, 1, 3}, 1);
  gltf.mesh(R"("POSITION":0)", R"(,"indices":1)");
  gltf.nodes = {R"({"mesh":0})"};
  const Mesh mesh = read(gltf).mesh;
  EXPECT_EQ(mesh.vertices.size(), 4U);
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {2, 1, 3}}));
  gltf.accessor<T>({0, 1, 4}, 1);
  gltf.meshes[0] = R"({"primitives":[{"attributes":{"POSITION":0},"indices":2}]})";
  EXPECT_EQ(refusal(gltf), "meshes[0].primitives[0].indices has 4 at 2; POSITION has 4 elements");
}

TEST(Gltf, IndicesAreOfEveryWidth) {
  expect_indices<uint8_t>();
  expect_indices<uint16_t>();
  expect_indices<uint32_t>();
}

TEST(Gltf, StripsAndFansWindAlike) {
  for (const bool is_strip : {true, false}) {
    GltfMaker gltf;
    // Around the origin for the fan, from side to side for the strip.
    gltf.accessor<float>(is_strip ? std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}
                                  : std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, -1, 1, 0},
                         3);
    gltf.mesh(R"("POSITION":0)", is_strip ? R"(,"mode":5)" : R"(,"mode":6)");
    gltf.nodes = {R"({"mesh":0})"};
    const Mesh mesh = read(gltf).mesh;
    EXPECT_EQ(mesh.triangles,
              is_strip ? (Triangles{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}) : (Triangles{{1, 2, 0}, {2, 3, 0}, {3, 4, 0}}));
    for (const auto& [a, b, c] : mesh.triangles) {
      EXPECT_GT(cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]).z, 0);
    }
  }
}

TEST(Gltf, NodesPlaceWhatHangsFromThem) {
  GltfMaker gltf = triangle();
  // A quarter turn about z, twice as large, then moved; below it the same mesh moved before, by a matrix.
  const std::string half = std::to_string(std::sqrt(0.5));
  gltf.nodes = {
      R"({"children":[1,2],"translation":[10,0,0],"scale":[2,2,2],"rotation":[0,0,)" + half + "," + half + "]}",
      R"({"mesh":0})", R"({"mesh":0,"matrix":[1,0,0,0, 0,1,0,0, 0,0,3,0, 5,0,7,1]})"};
  const Mesh mesh = read(gltf).mesh;
  const Points expected = {{10, 0, 0}, {10, 2, 0}, {8, 0, 0}, {10, 10, 14}, {10, 12, 14}, {8, 10, 14}};
  ASSERT_EQ(mesh.vertices.size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i) {
    EXPECT_LT(largest(abs(mesh.vertices[i] - expected[i])), 1e-5F) << i;
  }
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {3, 4, 5}}));
}

TEST(Gltf, MirroredTrianglesAreTurnedSoThatTheyStayCounterClockwise) {
  GltfMaker gltf;
  gltf.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, 3);
  gltf.accessor<uint8_t>({0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}, 1);  // outwards
  gltf.mesh(R"("POSITION":0)", R"(,"indices":1)");
  for (const char* scale : {"[1,1,1]", "[-1,1,1]", "[1,-2,1]", "[-1,-1,-1]", "[-1,-1,1]"}) {
    gltf.nodes = {std::string(R"({"mesh":0,"scale":)") + scale + "}"};
    const Mesh mesh = read(gltf).mesh;
    double volume = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
      volume += dot(mesh.vertices[a], cross(mesh.vertices[b], mesh.vertices[c]));
    }
    EXPECT_GT(volume, 0) << scale;
  }
}

TEST(Gltf, NormalsStandUprightUnderEveryTransform) {
  GltfMaker gltf;
  // A slope whose normal is (1, 1, 0), stretched and mirrored along x.
  gltf.accessor<float>({0, 1, 0, 1, 0, 0, 0, 1, 1}, 3);
  gltf.accessor<float>({1, 1, 0, 2, 2, 0, 1e-30F, 1e-30F, 0}, 3);
  gltf.mesh(R"("POSITION":0,"NORMAL":1)");
  gltf.nodes = {R"({"mesh":0,"scale":[-4,1,1],"translation":[5,6,7]})"};
  const Mesh mesh = read(gltf).mesh;
  EXPECT_TRUE(mesh.normal_corners.empty());
  ASSERT_EQ(mesh.normals.size(), 3U);
  const Vec3f along = mesh.vertices[1] - mesh.vertices[0];
  for (const Vec3f& normal : mesh.normals) {
    EXPECT_NEAR(dot(normal, along), 0, 1e-6);
    EXPECT_NEAR(dot(normal, normal), 1, 1e-6);
    EXPECT_GT(normal.y, 0);
  }
}

TEST(Gltf, OnlyTheDefaultSceneIsRead) {
  GltfMaker gltf = triangle();
  gltf.nodes = {R"({"mesh":0})", R"({"mesh":0,"translation":[1,0,0],"children":[2]})", R"({"mesh":0})"};
  const auto first_x = [&] { return read(gltf).mesh.vertices.at(0).x; };
  EXPECT_EQ(read(gltf).mesh.triangles.size(), 3U);  // no scene: all that is nobody's child, with what hangs from it
  gltf.scenes = {R"({"nodes":[1]})", R"({"nodes":[0]})"};
  EXPECT_EQ(first_x(), 1);
  EXPECT_EQ(read(gltf).mesh.triangles.size(), 2U);
  gltf.more = R"(,"scene":1)";
  EXPECT_EQ(first_x(), 0);
  EXPECT_EQ(read(gltf).mesh.triangles.size(), 1U);
  gltf.more = R"(,"scene":2)";
  EXPECT_EQ(refusal(gltf), "scene names scenes[2]; the file has 2");
}

TEST(Gltf, NodesInCirclesAreRefused) {
  const auto refused = [](std::vector<std::string> nodes, std::vector<std::string> scenes) {
    GltfMaker gltf = triangle();
    gltf.nodes = std::move(nodes);
    gltf.scenes = std::move(scenes);
    return refusal(gltf);
  };
  const std::string scene = R"({"nodes":[0]})";
  EXPECT_EQ(refused({R"({"children":[0]})"}, {scene}), "nodes[0] stands twice in the tree of nodes");
  EXPECT_EQ(refused({R"({"children":[1]})", R"({"children":[0]})"}, {scene}),
            "nodes[0] stands twice in the tree of nodes");
  EXPECT_EQ(refused({R"({"children":[1]})", R"({"children":[0]})"}, {}),
            "nodes[0] is among its own children's children");
  EXPECT_EQ(refused({R"({"children":[1,1]})", "{}"}, {scene}), "nodes[1] stands twice in the tree of nodes");
  EXPECT_EQ(refused({R"({"children":[1]})", "{}"}, {R"({"nodes":[0,1]})"}),
            "nodes[1] stands twice in the tree of nodes");
  EXPECT_EQ(refused({R"({"children":[7]})"}, {scene}), "the scene names nodes[7]; the file has 1");
  EXPECT_EQ(refused({R"({"children":[7]})"}, {}), "nodes[0].children names nodes[7]; the file has 1");
}

TEST(Gltf, ALongChainOfNodesIsNoMatter) {
  GltfMaker gltf = triangle();
  gltf.nodes.clear();
  constexpr int kCount = 100000;
  for (int i = 1; i < kCount; ++i) {
    gltf.nodes.push_back(R"({"translation":[1,0,0],"children":[)" + std::to_string(i) + "]}");
  }
  gltf.nodes.emplace_back(R"({"mesh":0})");
  gltf.scenes = {R"({"nodes":[0]})"};
  EXPECT_EQ(read(gltf).mesh.vertices.at(0).x, kCount - 1);
}

TEST(Gltf, PrimitivesShareWhatTheyHaveInCommon) {
  GltfMaker gltf;
  gltf.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, 3);
  gltf.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
  gltf.accessor<uint8_t>({0, 1, 2}, 1);
  gltf.accessor<uint8_t>({2, 1, 3}, 1);
  gltf.accessor<float>({9, 9, 9, 8, 8, 8, 7, 7, 7}, 3);
  const std::string first = R"({"attributes":{"POSITION":0,"NORMAL":1},"indices":2})";
  const std::string second = R"({"attributes":{"POSITION":0,"NORMAL":1},"indices":3})";
  const std::string flat = R"({"attributes":{"POSITION":4}})";
  gltf.nodes = {R"({"mesh":0})"};
  gltf.meshes = {"{\"primitives\":[" + first + "," + second + "]}"};
  Mesh mesh = read(gltf).mesh;
  EXPECT_EQ(mesh.vertices.size(), 4U);
  EXPECT_EQ(mesh.normals.size(), 4U);
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {2, 1, 3}}));
  EXPECT_TRUE(mesh.normal_corners.empty());
  gltf.meshes = {"{\"primitives\":[" + flat + "," + second + "]}"};
  mesh = read(gltf).mesh;
  constexpr uint32_t kNone = 0xFFFFFFFFU;
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {5, 4, 6}}));
  EXPECT_EQ(mesh.normal_corners, (Triangles{{kNone, kNone, kNone}, {2, 1, 3}}));
  expect_sound(mesh);
  // Without corners of their own there is a normal for every vertex, used or not.
  gltf.accessor_of<uint8_t>(0, 1, R"(,"bufferView":2)");
  gltf.meshes = {"{\"primitives\":[" + second + R"(,{"attributes":{"POSITION":4},"indices":5}]})"};
  EXPECT_EQ(read(gltf).mesh.normal_corners, (Triangles{{2, 1, 3}}));
}

TEST(Gltf, ATriangleWithANormalOfLength0IsFlat) {
  GltfMaker gltf;
  gltf.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, 3);
  gltf.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0}, 3);
  gltf.accessor<uint8_t>({0, 1, 2, 2, 1, 3}, 1);
  gltf.mesh(R"("POSITION":0,"NORMAL":1)", R"(,"indices":2)");
  gltf.nodes = {R"({"mesh":0})"};
  constexpr uint32_t kNone = 0xFFFFFFFFU;
  EXPECT_EQ(read(gltf).mesh.normal_corners, (Triangles{{0, 1, 2}, {kNone, kNone, kNone}}));
}

TEST(Gltf, QuantizedPositionsAndNormalsAreNumbersLikeOthers) {
  GltfMaker gltf;
  gltf.accessor<int16_t>({0, 0, 0, 0, 300, 0, 0, 0, 0, -200, 0, 0}, 3);
  gltf.views[0] = R"({"buffer":0,"byteLength":24,"byteStride":8})";
  gltf.accessors[0] = R"({"componentType":5122,"count":3,"type":"VEC3","bufferView":0})";  // padded to 8 bytes
  gltf.accessor<int8_t>({0, 0, 127, 0, 0, 127, 0, 0, 127}, 3, R"(,"normalized":true)");
  gltf.mesh(R"("POSITION":0,"NORMAL":1)");
  gltf.nodes = {R"({"mesh":0,"scale":[0.5,0.5,0.5]})"};
  gltf.more = R"(,"extensionsRequired":["KHR_mesh_quantization"])";
  Mesh mesh = read(gltf).mesh;
  EXPECT_EQ(mesh.vertices, (Points{{0, 0, 0}, {150, 0, 0}, {0, -100, 0}}));
  EXPECT_EQ(mesh.normals[0], (Vec3f{0, 0, 1}));
  gltf.accessors[0] = R"({"componentType":5122,"count":3,"type":"VEC3","bufferView":0,"normalized":true})";
  mesh = read(gltf).mesh;
  EXPECT_FLOAT_EQ(mesh.vertices[1].x, 150.F / 32767);
}

TEST(Gltf, SparseAccessorsReplaceSomeElements) {
  GltfMaker gltf = triangle();
  const float values[] = {4, 5, 6, 7, 8, 9};
  const int indices = gltf.view(std::string("\x02\x00", 2));
  const int replaced = gltf.view({reinterpret_cast<const char*>(values), sizeof values});
  const std::string sparse = R"(,"sparse":{"count":2,"indices":{"bufferView":)" + std::to_string(indices) +
                             R"(,"componentType":5121},"values":{"bufferView":)" + std::to_string(replaced) + "}}";
  const std::string accessor = gltf.accessors[0];
  gltf.accessors[0].insert(accessor.size() - 1, sparse);
  EXPECT_EQ(read(gltf).mesh.vertices, (Points{{7, 8, 9}, {1, 0, 0}, {4, 5, 6}}));
  gltf.accessors[0] = R"({"componentType":5126,"count":3,"type":"VEC3")" + sparse + "}";
  EXPECT_EQ(read(gltf).mesh.vertices, (Points{{7, 8, 9}, {0, 0, 0}, {4, 5, 6}}));
  gltf.accessors[0] = R"({"componentType":5126,"count":2,"type":"VEC3")" + sparse + "}";
  EXPECT_EQ(refusal(gltf), "accessors[0].sparse.indices has 2 at 0; the accessor has 2 elements");
  gltf.accessors[0] = R"({"componentType":5126,"count":999999999999,"type":"VEC3")" + sparse + "}";
  EXPECT_EQ(refusal(gltf), "accessors[0] has 999999999999 elements, for which the file has too few bytes");
}

TEST(Gltf, TheFirstPerspectiveCameraOfTheSceneIsTaken) {
  GltfMaker gltf = triangle();
  gltf.cameras = {R"({"type":"orthographic","orthographic":{"xmag":1,"ymag":1,"zfar":9,"znear":1}})",
                  R"({"type":"perspective","perspective":{"yfov":0.5,"znear":0.1}})",
                  R"({"type":"perspective","perspective":{"yfov":1.5,"znear":0.1}})"};
  const std::string half = std::to_string(std::sqrt(0.5));
  gltf.nodes = {R"({"mesh":0})", R"({"camera":0})", R"({"translation":[1,2,3],"scale":[5,5,5],"children":[3]})",
                R"({"camera":1,"rotation":[0,)" + half + ",0," + half + "]}", R"({"camera":2})"};
  const Model model = read(gltf);
  ASSERT_TRUE(model.camera);
  const auto near = [](Vec3d a, Vec3d b) { return largest(abs(a - b)) < 1e-5; };
  EXPECT_TRUE(near(model.camera->eye, {1, 2, 3}));
  EXPECT_TRUE(near(model.camera->look_at, {0, 2, 3}));  // turned to the left, from -z
  EXPECT_TRUE(near(model.camera->up, {0, 1, 0}));
  EXPECT_NEAR(model.camera->fov, 0.5 * 180 / M_PI, 1e-9);
  EXPECT_EQ(model.notes, (std::vector<std::string>{"cameras that are not perspective have no effect (cameras[0])"}));
  gltf.cameras[1] = R"({"type":"perspective","perspective":{"yfov":3.5,"znear":0.1}})";
  EXPECT_EQ(refusal(gltf), "cameras[1].perspective.yfov is 3.5; expected more than 0 and less than pi");
}

TEST(Gltf, IsReadByItsName) {
  const Folder folder;
  EXPECT_EQ(read_model(folder.write("a.gltf", triangle().embedded())).mesh.triangles.size(), 1U);
  EXPECT_EQ(read_model(folder.write("A.GLB", triangle().glb())).mesh.triangles.size(), 1U);
  const std::vector<std::string> extensions = model_extensions();
  for (const char* own : {".ply", ".obj", ".stl", ".gltf", ".glb"}) {
    EXPECT_EQ(std::count(extensions.begin(), extensions.end(), own), 1) << own;
  }
  EXPECT_EQ(error_of(ErrorCode::file, [] { read_model("a.gtlf"); }),
            "a.gtlf: its name ends with '.gtlf', which no reader of this build knows; did you mean '.gltf'?");
}

TEST(Gltf, WhatCannotBeShownIsSaidOnce) {
  GltfMaker gltf = triangle();
  gltf.accessor<float>({1, 1, 1, 1, 1, 1, 1, 1, 1}, 3);
  const std::string points = R"({"attributes":{"POSITION":0},"mode":0})",
                    lines = R"({"attributes":{"POSITION":0},"mode":3})";
  gltf.meshes = {
      R"({"primitives":[)" + points + "," + lines +
      R"(,{"attributes":{"POSITION":0,"COLOR_0":1},"targets":[{"POSITION":1}]},{"attributes":{"NORMAL":1}}]})"};
  gltf.nodes = {R"({"mesh":0,"skin":0})", R"({"mesh":0,"skin":0,"extensions":{"KHR_lights_punctual":{"light":0}}})"};
  gltf.more = R"(,"skins":[{"joints":[0]}],"animations":[{"channels":[],"samplers":[]}],)"
              R"("extensionsUsed":["KHR_lights_punctual","EXT_strange"],)"
              R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"point"}]}})";
  const Model model = read(gltf);
  EXPECT_EQ(model.mesh.triangles.size(), 2U);
  EXPECT_EQ(model.notes, (std::vector<std::string>{
                             "animations have no effect",
                             "extensions that have no effect: EXT_strange",
                             "skins have no effect; the mesh is shown as it is without one (nodes[0] and 1 more)",
                             "lights of the file have no effect (nodes[1])",
                             "points and lines are left out (meshes[0].primitives[0] and 1 more)",
                             "morph targets have no effect (meshes[0].primitives[2])",
                             "colours of vertices have no effect (meshes[0].primitives[2])",
                             "what has no POSITION is left out (meshes[0].primitives[3])",
                         }));
}

}  // namespace
}  // namespace kerf::test
