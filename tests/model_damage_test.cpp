// What becomes of OBJ, MTL and STL files that are cut short or damaged, and of nonsense.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <new>
#include <numeric>
#include <random>

#include "kerf/base/error.h"
#include "kerf/geometry/hit.h"
#include "kerf/io/obj.h"
#include "kerf/io/obj/mtl.h"
#include "kerf/io/stl.h"
#include "small_images.h"

namespace {
std::atomic<size_t> largest_request = 0;  // of operator new, in bytes
}

// Counted here rather than by a limit of the system, which the sanitizers do not bear. Not inlined, or g++ sees free()
// called for what new has given.
[[gnu::noinline]] void* operator new(size_t size) {
  size_t largest = largest_request;
  while (size > largest && !largest_request.compare_exchange_weak(largest, size)) {
  }
  if (void* memory = std::malloc(std::max<size_t>(size, 1))) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, size_t) noexcept { std::free(memory); }

namespace kerf::test {
namespace {

void check_corners(const std::vector<Mesh::Corners>& corners, size_t triangles, size_t values) {
  EXPECT_EQ(corners.size(), triangles);
  for (const Mesh::Corners& corner : corners) {
    for (const uint32_t number : corner) EXPECT_TRUE(number == kNone || number < values);
  }
}

void check_mesh(const Mesh& mesh) {
  for (const Mesh::Corners& triangle : mesh.triangles) {
    for (const uint32_t corner : triangle) EXPECT_LT(corner, mesh.vertices.size());
  }
  const size_t triangles = mesh.triangles.size();
  const auto check = [&](const std::vector<Mesh::Corners>& corners, size_t values) {
    if (!corners.empty()) check_corners(corners, triangles, values);
    if (corners.empty() && values > 0) {
      EXPECT_EQ(values, mesh.vertices.size());
    }
  };
  check(mesh.uv_corners, mesh.uvs.size());
  check(mesh.normal_corners, mesh.normals.size());
  EXPECT_TRUE(mesh.materials.empty() || mesh.materials.size() == triangles);
}

void check_share(float value) { EXPECT_TRUE(value >= 0 && value <= 1) << value; }

void check_material(const Material& material) {
  for (uint32_t axis = 0; axis < 3; ++axis) {
    check_share(material.albedo[axis]);
    EXPECT_TRUE(material.emission[axis] >= 0 && std::isfinite(material.emission[axis]));
  }
  check_share(material.roughness);
  check_share(material.metallic);
  check_share(material.transmission);
  EXPECT_TRUE(material.refractive_index > 0 && std::isfinite(material.refractive_index));
}

// Each returns normally or throws what the reader throws; none needs a file.

void load_obj(const std::vector<char>& bytes) {
  const Model model = parse_obj(bytes, "/nowhere/test.obj");
  check_mesh(model.mesh);
  for (const Material& material : model.materials) check_material(material);
  for (const uint32_t number : model.mesh.materials) EXPECT_LT(number, model.materials.size());
}

void load_mtl(const std::vector<char>& bytes) {
  for (const MtlMaterial& made : parse_mtl(bytes, "test.mtl").materials) check_material(made.material);
}

void load_stl(const std::vector<char>& bytes) { check_mesh(parse_stl(bytes, "test.stl")); }

using Loader = std::function<void(const std::vector<char>&)>;

/// Whether it loads; what it throws must be an Error that says where and why.
bool loads(const Loader& load, const std::string& text) {
  const std::vector<char> bytes(text.begin(), text.end());  // so that the address sanitizer sees a read behind it
  try {
    load(bytes);
    return true;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::file);
    EXPECT_NE(error.place().find("test."), std::string::npos) << error.what();
    EXPECT_GT(std::string(error.what()).size(), error.place().size() + 2);
    return false;
  }
}

/// Something of everything.
const std::string kObj =
    "\xEF\xBB\xBF# c\\\r\nmtllib a.mtl b.mtl\no x\nv 0 0 0\nv 1 .5 -1e-3 1\r\nv 1 1 nan\nv 0 0 0 1 1 1\nvt 0 1\nvt .5\n"
    "vn 0 0 1\nvn 0 0 0\nusemtl a b\nf 1 2 3 4\ns 1\nf -1/1/1 -2/2/1 -3/-1/-1 \\\n 4/1/2\nusemtl\nf 1//1 2//2 3//1 "
    "#\nl 1 2\nf "
    "1/1 2/2 3/1";

const std::string kMtl =
    "# c\nnewmtl a\nKa 1 1 1\nKd .1 .2 .3\nKs 1\nKe 0 9 0\nNs 10\nNi 1.5\nd .5\nTr .5\nillum 7\nnewmtl b c\r\nPr "
    ".5\nPm 1\n"
    "map_Kd -s 1 1 -clamp on a b.png\nmap_Bump -bm 1 x\nnewmtl a\nd -halo 0\nKd spectral x\nNi \\\n2";

const std::string kAsciiStl =
    "solid a b\nfacet normal 0 0 1\n outer loop\n vertex 0 0 0\n vertex 1e0 -0 0\r\n vertex 1 1 .5 "
    "endloop\nendfacet\nendsolid\n"
    "solid\nendsolid";

/// Two triangles that share two vertices.
std::string binary_stl() {
  const std::string zero = little(0, 12), x = little(0x3F800000, 4) + little(0, 8),
                    y = little(0, 4) + little(0x3F800000, 8);
  return std::string(80, 's') + little(2, 4) + zero + zero + x + y + "aa" + zero + zero + y + x + "aa";
}

struct Kind {
  std::string text;
  Loader load;
};

std::vector<Kind> kinds() {
  return {{kObj, load_obj}, {kMtl, load_mtl}, {kAsciiStl, load_stl}, {binary_stl(), load_stl}};
}

TEST(ModelDamage, NoCutDoesHarm) {
  for (const Kind& kind : kinds()) {
    EXPECT_TRUE(loads(kind.load, kind.text));
    size_t loaded = 0;
    for (size_t size = 0; size < kind.text.size(); ++size)
      loaded += loads(kind.load, kind.text.substr(0, size)) ? 1 : 0;
    EXPECT_LT(loaded, kind.text.size());
  }
}

TEST(ModelDamage, NoDamagedByteDoesHarm) {
  for (const Kind& kind : kinds()) {
    size_t loaded = 0;
    largest_request = 0;
    for (size_t at = 0; at < kind.text.size(); ++at) {
      for (int byte = 0; byte < 256; ++byte) {
        std::string damaged = kind.text;
        damaged[at] = static_cast<char>(byte);
        loaded += loads(kind.load, damaged) ? 1 : 0;
      }
    }
    EXPECT_GE(loaded, kind.text.size());  // each byte once as it was
    EXPECT_LT(largest_request, 30000U);
  }
}

TEST(ModelDamage, NoNonsenseDoesHarm) {
  const std::vector<std::string> words = {"v",
                                          "vt",
                                          "vn",
                                          "f",
                                          "usemtl",
                                          "mtllib",
                                          "newmtl",
                                          "Kd",
                                          "illum",
                                          "d",
                                          "Tr",
                                          "map_Kd",
                                          "-s",
                                          "-o",
                                          "#",
                                          "\\\n",
                                          "\\",
                                          "\r",
                                          "\n",
                                          "\n",
                                          "\n",
                                          "0",
                                          "1",
                                          "-1",
                                          "1/1",
                                          "1//1",
                                          "1/1/1",
                                          "-1//-1",
                                          "1e99",
                                          "nan",
                                          "-0",
                                          "solid",
                                          "facet",
                                          "normal",
                                          "outer",
                                          "loop",
                                          "vertex",
                                          "endloop",
                                          "endfacet",
                                          "endsolid",
                                          "x",
                                          "l",
                                          "9999999999999999999999",
                                          std::string(1, '\0'),
                                          "\xFF"};
  std::mt19937 random(1);
  size_t loaded = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string text = i % 4 == 3 ? "solid\n" : i % 4 == 2 ? "newmtl a\n" : "";
    for (size_t count = random() % 30; count > 0; --count) {
      text += words[random() % words.size()];
      if (random() % 8 != 0) text += ' ';
    }
    for (const Loader& load : {Loader(load_obj), Loader(load_mtl), Loader(load_stl)})
      loaded += loads(load, text) ? 1 : 0;
  }
  EXPECT_GT(loaded, 0U);
}

TEST(ModelDamage, MemoryStaysInProportionToTheFile) {
  std::string corners = "v 0 0 0\nv 0 0 0\nv 0 0 0\nf", keywords, uses = "v 0 0 0\n";
  for (int i = 0; i < 50000; ++i) corners += " 1";
  for (int i = 0; i < 50000; ++i) keywords += "v\n";
  for (int i = 0; i < 20000; ++i) uses += "usemtl " + std::to_string(i) + "\nf 1 1 1\n";
  for (const std::string& text : {corners, keywords, uses}) {
    largest_request = 0;
    loads(load_obj, text);
    EXPECT_LT(largest_request, 20 * text.size());
  }
  // A binary STL that states more than it has.
  std::string lie = binary_stl();
  lie.replace(80, 4, "\xFF\xFF\xFF\xFF");
  largest_request = 0;
  EXPECT_FALSE(loads(load_stl, lie));
  EXPECT_LT(largest_request, 10000U);
}

}  // namespace
}  // namespace kerf::test
