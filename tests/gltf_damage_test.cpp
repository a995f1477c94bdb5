// What becomes of glTFs that lie, are cut short or are damaged.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <new>

#include "gltf_text.h"
#include "support/random.h"

namespace {
size_t largest_request = 0;  // of operator new, in bytes
}

// Counted here rather than by a limit of the system, which the sanitizers do not bear. Not inlined, or g++ sees free()
// called for what new has given.
[[gnu::noinline]] void* operator new(size_t size) {
  largest_request = std::max(largest_request, size);
  if (void* memory = std::malloc(std::max<size_t>(size, 1))) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, size_t) noexcept { std::free(memory); }

namespace kerf::test {
namespace {

/// A bit of everything: two primitives, nodes, a material, a sparse accessor, a camera, an image in the buffer.
GltfMaker everything() {
  GltfMaker gltf;
  gltf.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, 3,
                       R"(,"sparse":{"count":1,)"
                       R"("indices":{"bufferView":0,"componentType":5121,"byteOffset":20},"values":{"bufferView":0}})");
  gltf.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
  gltf.accessor<uint8_t>({0, 0, 255, 0, 0, 255, 255, 255}, 2, R"(,"normalized":true)");
  gltf.accessor<uint16_t>({0, 1, 2, 2, 1, 3}, 1);
  gltf.meshes = {R"({"primitives":[{"attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2},"indices":3,"material":0},)"
                 R"({"attributes":{"POSITION":0},"mode":5}]})"};
  gltf.nodes = {R"({"mesh":0,"children":[1]})", R"({"mesh":0,"scale":[-1,1,1],"rotation":[0,0,0,1],"camera":0})"};
  gltf.scenes = {R"({"nodes":[0]})"};
  gltf.cameras = {R"({"type":"perspective","perspective":{"yfov":1,"znear":0.1}})"};
  const int view = gltf.view("no image");
  gltf.images = {R"({"bufferView":)" + std::to_string(view) + "}"};
  gltf.textures = {R"({"source":0})"};
  gltf.materials = {R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":)"
                    R"({"KHR_texture_transform":{"offset":[1,0]}}}},"extensions":{"KHR_materials_ior":{"ior":1.5}}})"};
  return gltf;
}

/// Reads it, and checks what comes of it: a sound model, or an error. True for a model.
bool load(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
  try {
    expect_sound(read_gltf(path));
    return true;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::file);
    EXPECT_EQ(error.place(), path);
    EXPECT_GT(std::string(error.what()).size(), path.size() + 10);
    return false;
  }
}

TEST(GltfDamage, TheWholeFileIsRight) {
  const Folder folder;
  const Model model = read(folder, everything().glb());
  EXPECT_EQ(model.mesh.triangles.size(), 8U);
  EXPECT_EQ(model.mesh.vertices.size(), 8U);
  EXPECT_TRUE(model.camera);
  expect_sound(model);
}

TEST(GltfDamage, AFileCutShortAnywhereIsAnError) {
  const Folder folder;
  for (const std::string& whole : {everything().glb(), everything().embedded()}) {
    ASSERT_TRUE(load(folder.path("a.glb"), whole));
    for (size_t size = 0; size < whole.size(); ++size) {
      EXPECT_FALSE(load(folder.path("a.glb"), whole.substr(0, size))) << size << " of " << whole.size();
    }
  }
}

TEST(GltfDamage, NoChangedByteDoesHarm) {
  const Folder folder;
  largest_request = 0;
  size_t loaded = 0;
  const std::string values = {'\0', '\x7F', '\xFF', '0', '9', '"', '{', ','};
  const std::string whole = everything().glb();
  std::string damaged = whole;
  for (size_t i = 0; i < whole.size(); ++i) {
    for (const char value : values) {
      damaged[i] = value;
      loaded += load(folder.path("a.glb"), damaged) ? 1 : 0;
    }
    damaged[i] = whole[i];
  }
  EXPECT_GT(loaded, whole.size());
  EXPECT_LT(largest_request, 200000U);
}

TEST(GltfDamage, NoRandomBytesDoHarm) {
  const Folder folder;
  Random random(1);
  const std::string whole = everything().glb();
  for (int i = 0; i < 2000; ++i) {
    std::string bytes = whole;
    const uint32_t count = 1 + random.below(20);
    for (uint32_t k = 0; k < count; ++k) {
      bytes[random.below(static_cast<uint32_t>(bytes.size()))] = static_cast<char>(random.bits());
    }
    load(folder.path("a.glb"), bytes);
    std::string noise(random.below(200), '\0');
    for (char& c : noise) c = static_cast<char>(random.bits());
    EXPECT_FALSE(load(folder.path("a.glb"), noise));
    EXPECT_FALSE(load(folder.path("a.glb"), whole.substr(0, 20) + noise));
  }
}

TEST(GltfDamage, ContainersThatLieAreRefused) {
  const Folder folder;
  const std::string whole = triangle().glb();
  const auto refused = [&](size_t at, uint32_t number) {
    std::string bytes = whole;
    bytes.replace(at, 4, bytes_of(number));
    return refusal(folder, bytes);
  };
  const std::string size = std::to_string(whole.size());
  const auto json = static_cast<uint32_t>(triangle().json("").size() + 3) / 4 * 4;
  EXPECT_EQ(refused(4, 1), "is a GLB of version 1; only 2 can be read");
  EXPECT_EQ(refused(8, 0xFFFFFFFFU), "is cut short: its header says 4294967295 bytes, and there are " + size);
  EXPECT_EQ(refused(8, 16), "has half a chunk header at byte 12");
  EXPECT_EQ(refused(8, 12), "has no JSON chunk");
  EXPECT_EQ(refused(12, 0xFFFFFFFFU), "has a chunk of 4294967295 bytes at byte 20, where only " +
                                          std::to_string(whole.size() - 20) + " are left");
  EXPECT_EQ(refused(16, 0), "does not begin with a JSON chunk");
  EXPECT_EQ(refused(20 + json, 40),
            "has a chunk of 40 bytes at byte " + std::to_string(28 + json) + ", where only 36 are left");
  EXPECT_EQ(refused(24 + json, 7), "buffers[0] has no uri, and there is no binary chunk for it");
  EXPECT_EQ(refusal(folder, "glTF\2"), "is cut short in the header of a GLB, after 5 bytes");
  EXPECT_EQ(read(folder, whole + "what follows is no part of it").mesh.triangles.size(), 1U);
}

/// The triangle with one of its lists replaced.
std::string refused(std::vector<std::string> GltfMaker::*list, const std::string& object) {
  GltfMaker gltf = triangle();
  gltf.*list = {object};
  return refusal(gltf);
}

TEST(GltfDamage, AccessorsThatReachTooFarAreRefused) {
  const auto accessor = [](const std::string& text) {
    return refused(&GltfMaker::accessors, R"({"componentType":5126,"type":"VEC3",)" + text + "}");
  };
  EXPECT_EQ(accessor(R"("bufferView":0,"count":4)"),
            "accessors[0] has 4 elements of 12 bytes from byte 0 on; bufferViews[0] has 36 bytes");
  EXPECT_EQ(accessor(R"("bufferView":0,"count":3,"byteOffset":4)"),
            "accessors[0] has 3 elements of 12 bytes from byte 4 on; bufferViews[0] has 36 bytes");
  // Products and sums that overflow 64 bits.
  for (const std::string count : {"1537228672809129302", "6148914691236517205", "18446744073709551615"}) {
    EXPECT_EQ(accessor(R"("bufferView":0,"count":)" + count),
              "accessors[0] has " + count + " elements of 12 bytes from byte 0 on; bufferViews[0] has 36 bytes");
  }
  EXPECT_EQ(accessor(R"("bufferView":0,"count":3,"byteOffset":18446744073709551604)"),
            "accessors[0] has 3 elements of 12 bytes from byte 18446744073709551604 on; bufferViews[0] has 36 bytes");
  EXPECT_EQ(accessor(R"("bufferView":1,"count":3)"), "accessors[0] names bufferViews[1]; the file has 1");
  EXPECT_EQ(accessor(R"("count":3)"),
            "accessors[0], which meshes[0].primitives[0].attributes.POSITION names, has no bufferView");
  EXPECT_EQ(
      refused(&GltfMaker::accessors, R"({"componentType":5123,"type":"VEC2","bufferView":0,"count":3})"),
      "meshes[0].primitives[0].attributes.POSITION must have 3 components, FLOAT or of at most 16 bits; accessors[0] "
      "has 2 of UNSIGNED_SHORT");
  EXPECT_EQ(refused(&GltfMaker::accessors, R"({"componentType":5130,"type":"VEC3","bufferView":0,"count":1})"),
            "accessors[0] has the component type 5130");
  EXPECT_EQ(refused(&GltfMaker::accessors, R"({"componentType":5126,"type":"MAT4","bufferView":0,"count":1})"),
            "accessors[0] is of matrices; meshes[0].primitives[0].attributes.POSITION wants vectors or single numbers");
}

TEST(GltfDamage, ViewsThatReachTooFarAreRefused) {
  const auto view = [](const std::string& text) { return refused(&GltfMaker::views, R"({"buffer":0,)" + text + "}"); };
  EXPECT_EQ(view(R"("byteLength":37)"), "bufferViews[0] has 37 bytes from byte 0 on; buffers[0] has 36");
  EXPECT_EQ(view(R"("byteLength":36,"byteOffset":1)"), "bufferViews[0] has 36 bytes from byte 1 on; buffers[0] has 36");
  EXPECT_EQ(view(R"("byteLength":18446744073709551615,"byteOffset":2)"),
            "bufferViews[0] has 18446744073709551615 bytes from byte 2 on; buffers[0] has 36");
  EXPECT_EQ(view(R"("byteLength":36,"byteStride":8)"),
            "accessors[0] has elements of 12 bytes; bufferViews[0] has a byteStride of 8");
  EXPECT_EQ(view(R"("byteLength":36,"byteStride":16)"),
            "accessors[0] has 3 elements of 12 bytes from byte 0 on; bufferViews[0] has 36 bytes");
  EXPECT_EQ(refused(&GltfMaker::views, R"({"buffer":1,"byteLength":36})"), "buffers[1] is not there; the file has 1");
  EXPECT_EQ(refused(&GltfMaker::views, R"({"buffer":0})").substr(0, 16), "is no glTF 2.0: ");
}

TEST(GltfDamage, WrongMeshesAndNodesAreRefused) {
  const auto primitive = [](const std::string& text) {
    return refused(&GltfMaker::meshes, R"({"primitives":[{"attributes":{"POSITION":0},)" + text + "}]}");
  };
  EXPECT_EQ(primitive(R"("mode":7)"), "meshes[0].primitives[0].mode is 7; expected 0 to 6");
  EXPECT_EQ(primitive(R"("material":0)"), "meshes[0].primitives[0] names materials[0]; the file has 0");
  EXPECT_EQ(primitive(R"("indices":0)"),
            "meshes[0].primitives[0].indices must be single unsigned integers; accessors[0] "
            "has FLOAT of 3 components");
  EXPECT_EQ(primitive(R"("indices":1)").substr(0, 16), "is no glTF 2.0: ");
  GltfMaker gltf = triangle();
  gltf.accessors[0].replace(gltf.accessors[0].find("\"count\":3"), 9, "\"count\":2");
  EXPECT_EQ(refusal(gltf), "meshes[0].primitives[0] has 2 corners; expected a multiple of 3");
  gltf.meshes = {R"({"primitives":[{"attributes":{"POSITION":0},"mode":5}]})"};
  EXPECT_EQ(refusal(gltf), "meshes[0].primitives[0] has 2 corners; expected at least 3");
  gltf = triangle();
  gltf.accessor<float>({0, 0, 1, 0, 0, 1}, 3);
  gltf.mesh(R"("POSITION":0,"NORMAL":1)");
  gltf.nodes = {R"({"mesh":1})"};
  EXPECT_EQ(refusal(gltf), "meshes[1].primitives[0].attributes.NORMAL has 2 elements, and POSITION has 3");
  EXPECT_EQ(refused(&GltfMaker::nodes, R"({"mesh":1})"), "nodes[0] names meshes[1]; the file has 1");
  EXPECT_EQ(refused(&GltfMaker::nodes, R"({"scale":[1,2]})"), "nodes[0].scale has 2 numbers; expected 3");
  EXPECT_EQ(refused(&GltfMaker::nodes, R"({"rotation":[0,0,0,0]})"), "nodes[0].rotation is a quaternion of length 0");
  EXPECT_EQ(refused(&GltfMaker::nodes, R"({"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,2]})"),
            "nodes[0].matrix is no affine transform: its last row is 0, 0, 0, 2");
}

TEST(GltfDamage, ValuesOfTheWrongTypeAreRefusedWithTheirPlace) {
  EXPECT_EQ(refused(&GltfMaker::accessors,
                    R"({"componentType":5126,"type":"VEC3","bufferView":0,"count":3,"byteOffset":-4})"),
            "accessors[0].byteOffset is -4; expected an integer of at least 0");
  EXPECT_EQ(refused(&GltfMaker::accessors, R"({"componentType":5126,"type":"VEC3","bufferView":4294967296,"count":3})"),
            "accessors[0].bufferView is 4294967296; expected an integer from 0 to 2147483647");
  EXPECT_EQ(refused(&GltfMaker::nodes, R"({"mesh":0.0})"),
            "nodes[0].mesh is 0.0; expected an integer from 0 to 2147483647");
  EXPECT_EQ(refused(&GltfMaker::nodes, R"({"mesh":"0"})"),
            "nodes[0].mesh is '0'; expected an integer from 0 to 2147483647");
  EXPECT_EQ(refused(&GltfMaker::nodes, R"({"scale":[1,null,1]})"), "nodes[0].scale[1] is null; expected a number");
  EXPECT_EQ(refused(&GltfMaker::nodes, R"({"scale":{}})"), "nodes[0].scale is an object; expected an array");
  EXPECT_EQ(refused(&GltfMaker::nodes, R"({"mesh":0,"m\u0065sh":1})"), "nodes[0].m\\u0065sh stands twice");
  EXPECT_EQ(refused(&GltfMaker::meshes, R"({"primitives":[{"attributes":{"POSITION":true}}]})"),
            "meshes[0].primitives[0].attributes.POSITION is true; expected an integer from 0 to 2147483647");
  // What is not read may be anything.
  GltfMaker gltf = triangle();
  gltf.nodes = {
      R"({"mesh":0,"name":7,"text":"a\"b\\","extras":{"mesh":"0","extensions":5},"sca.le":1,"":{"mesh":0.5}})"};
  EXPECT_EQ(read(gltf).mesh.triangles.size(), 1U);
}

TEST(GltfDamage, OtherVersionsAndRequiredExtensionsAreRefused) {
  GltfMaker gltf = triangle();
  gltf.version = "1.0";
  EXPECT_EQ(refusal(gltf), "is glTF of version 1.0; only 2 can be read");
  gltf.version = "2.1\",\"minVersion\":\"2.1";
  EXPECT_EQ(refusal(gltf), "needs a reader of glTF 2.1; 2.0 can be read");
  gltf.version = "2.0";
  gltf.more =
      R"(,"extensionsRequired":["KHR_texture_transform","KHR_draco_mesh_compression","EXT_meshopt_compression"])";
  gltf.accessors[0] = R"({"componentType":5126,"type":"VEC3","count":3})";
  EXPECT_EQ(refusal(gltf),
            "requires extensions that cannot be read: KHR_draco_mesh_compression, EXT_meshopt_compression");
}

TEST(GltfDamage, WhatIsNoJsonIsRefusedWithLineAndColumn) {
  const Folder folder;
  EXPECT_EQ(refusal(folder, ""), "is no JSON at line 1, column 1: the text is cut short");
  EXPECT_EQ(refusal(folder, "hello"), "is no JSON at line 1, column 1: expected a value");
  EXPECT_EQ(refusal(folder, "{\n  \"a\": [1,\n 2 3]}"), "is no JSON at line 3, column 4: expected ']'");
  EXPECT_EQ(refusal(folder, "{\"a"), "is no JSON at line 1, column 3: a string without an end");
  EXPECT_EQ(refusal(folder, "{} {}"), "is no JSON at line 1, column 4: expected the end of the file");
  EXPECT_EQ(refusal(folder, "{}"), "is no glTF 2.0: it has no asset.version");
  EXPECT_EQ(refusal(folder, R"({"asset":{"version":"2.0"},"x":01})").substr(0, 16), "is no glTF 2.0: ");
  EXPECT_EQ(refusal(folder, "{\"asset\":{\"version\":\"2.0\"},\"x\":\"\xFF\"}").substr(0, 16), "is no glTF 2.0: ");
}

TEST(GltfDamage, DeepNestingIsRefused) {
  const Folder folder;
  const auto nested = [&](size_t depth) {
    const std::string open(depth - 1, '['), close(depth - 1, ']');
    return R"({"asset":{"version":"2.0"},"extras":)" + open + close + "}";
  };
  EXPECT_TRUE(read(folder, nested(100)).mesh.triangles.empty());
  for (const size_t depth : {101, 1000000}) {
    EXPECT_NE(refusal(folder, nested(depth)).find("nested deeper than 100"), std::string::npos);
  }
}

}  // namespace
}  // namespace kerf::test
