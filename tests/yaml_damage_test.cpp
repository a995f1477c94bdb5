// What becomes of YAML scenes that are cut short, damaged or made to do harm.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <new>

#include "support/random.h"
#include "yaml_text.h"

namespace {
size_t requested = 0;  // of operator new since it was set to 0, in bytes
}

// Not inlined, or g++ sees free() called for what new has given.
[[gnu::noinline]] void* operator new(size_t size) {
  requested += size;
  if (void* memory = std::malloc(std::max<size_t>(size, 1))) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, size_t) noexcept { std::free(memory); }

namespace kerf::test {
namespace {

/// Something of everything, without a file.
const std::string kSample =
    "# all\nscene: {name: \"a \\\"room\\\"\", description: 'it''s'}\ncamera:\n  position: &p [0, 1.5, -3e1]\n  up:\n"
    "  - 0\n  - 1\n  - 0\nsettings: {ambient_light: .5, use_bvh: true, structure: sweep_sah}\nmaterials:\n"
    "  - name: &m red\n    albedo: [1, 0, 0]\n  - {name: l, type: light, color: [1, 1, 1], emission_intensity: 2}\n"
    "geometry:\n  - {type: sphere, material: *m, center: *p, radius: 1}\n  - type: triangle\n    material: l\n"
    "    v0: [0, 0, 0]\n    v1: [1, 0, 0]\n    v2: [0, 1, 0]\n    visible: false\n"
    "  - {type: rectangle, material: red, corner: [0, 0, 0], u: [1, 0, 0], v: [0, 1, 0]}\n";

/// Whether it is a scene; all that is not must be an Error (file) with a place.
bool loads(const std::string& text) {
  try {
    const SceneDescription scene = parse(text);
    for (const SceneObject& object : scene.objects) {
      EXPECT_LT(object.material, scene.materials.size());
      if (const auto* mesh = std::get_if<Mesh>(&object.shape)) {
        for (const uint32_t material : mesh->materials) EXPECT_LT(material, scene.materials.size());
      }
    }
    return true;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::file) << text;
    EXPECT_TRUE(error.place().starts_with("t.yaml")) << error.what();
    return false;
  }
}

TEST(YamlDamage, NoCutDoesHarm) {
  ASSERT_TRUE(loads(kSample));
  size_t loaded = 0;
  for (size_t size = 0; size < kSample.size(); ++size) loaded += loads(kSample.substr(0, size)) ? 1 : 0;
  // A text cut between two items is a smaller scene.
  EXPECT_GT(loaded, 3U);
  EXPECT_LT(loaded, kSample.size() / 4);
}

TEST(YamlDamage, NoChangedByteDoesHarm) {
  std::vector<char> bytes = {'\0', '\4', '\t', '\x7F', '\x80', '\xFF'};
  for (const char c : std::string(" \n\r[]{},:-?#&*!|>'\"%@`~\\.0a+")) bytes.push_back(c);
  size_t loaded = 0;
  for (size_t at = 0; at < kSample.size(); ++at) {
    for (const char byte : bytes) {
      std::string text = kSample;
      text[at] = byte;
      loaded += loads(text) ? 1 : 0;
    }
  }
  EXPECT_GT(loaded, kSample.size() / 2) << "comments, names and digits";
}

TEST(YamlDamage, NoRandomTextDoesHarm) {
  Random random(7);
  const std::string words[] = {"camera",   "materials", "geometry", "type", "sphere", "name", ": ",   "- ",   "\n",
                               "\n  ",     "[",         "]",        "{",    "}",      ", ",   "\"",   "'",    "&a ",
                               "*a ",      "!x ",       "? ",       "| ",   "> ",     "#",    " ",    "\t",   "1",
                               "<<",       "---",       "...",      "~",    "%",      "\\",   "\r\n", "v0",   "true",
                               "\n      ", "fov",       "obj",      "file", "\xC3",   ":",    "-",    "\n- ", ","};
  for (int i = 0; i < 20000; ++i) {
    std::string text;
    for (uint32_t length = random.below(25); length > 0; --length) text += words[random.below(std::size(words))];
    loads(text);
  }
}

std::string repeated(const std::string& part, size_t count) {
  std::string text;
  for (size_t i = 0; i < count; ++i) text += part;
  return text;
}

TEST(YamlDamage, DeepNestingIsRefusedBeforeTheStackEnds) {
  for (const std::string part : {"[", "{", "- ", "? ", ": ", "[a, ", "{a: ", "[\n", "- - ", "[? "}) {
    SCOPED_TRACE(part);
    EXPECT_NE(error_of(repeated(part, 100000)).find("more than 64 levels"), std::string::npos);
    EXPECT_NE(error_of("camera: " + repeated(part, 100000)), "no error");
  }
  EXPECT_NE(error_of(repeated("&a [*a, ", 64)), "no error");
  EXPECT_EQ(error_of("scene: {name: " + repeated("[", 62) + repeated("]", 62) + "}"),
            "t.yaml:1:15: name: expected a text, found a list of 1")
      << "64 levels are right";
  EXPECT_EQ(error_of("scene: {name: " + repeated("[", 63) + repeated("]", 63) + "}"),
            "t.yaml:1:77: more than 64 levels");
}

TEST(YamlDamage, MemoryStaysInProportion) {
  // Twice the text takes twice as much; what is quadratic takes four times.
  for (const std::string part :
       {"[", "x", "\n", "'", "\"", "# ", "\n- ", "x: [", "&a ", "? x\n", "\n#", "- x\n", "[1,2],"}) {
    SCOPED_TRACE(part);
    size_t bytes[2] = {};
    for (const size_t i : {0U, 1U}) {
      const std::string text = repeated(part, 20000 << i);
      requested = 0;
      loads(text);
      bytes[i] = requested;
    }
    EXPECT_LT(bytes[1], 2.5 * static_cast<double>(bytes[0]) + 100000);
  }
}

TEST(YamlDamage, AliasesOfAliasesAreNotWrittenOut) {
  std::string text = "scene:\n  name: &a0 [x]\n";
  for (int i = 1; i < 60; ++i) {
    text += "k" + std::to_string(i) + ": &a" + std::to_string(i) + " [" +
            repeated("*a" + std::to_string(i - 1) + ", ", 10) + "]\n";
  }
  requested = 0;
  EXPECT_NE(error_of(text), "no error");
  EXPECT_LT(requested, 3000000U);
}

TEST(YamlDamage, ManyOfOneKindAreReadInLinearTime) {
  const auto seconds_for = [](size_t count) {
    std::string text = "materials:\n";
    for (size_t i = 0; i < count; ++i) text += "  - {name: m" + std::to_string(i) + ", metallic: 1}\n";
    text += "geometry:\n";
    for (size_t i = 0; i < count; ++i) {
      text +=
          "  - {type: triangle, material: m" + std::to_string(i) + ", v0: [0, 0, 0], v1: [1, 0, 0], v2: [0, 1, 0]}\n";
    }
    const std::clock_t begin = std::clock();  // of the processor: the machine may be busy
    const SceneDescription scene = parse(text);
    EXPECT_EQ(scene.objects.size(), 1U);
    EXPECT_EQ(scene.notes.size(), 1U);
    return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  };
  const double few = seconds_for(1500);
  EXPECT_LT(seconds_for(6000), 10 * few + 0.1) << "16 times as much if it were quadratic";
}

}  // namespace
}  // namespace kerf::test
