// What becomes of PLYs that lie, are cut short or are damaged.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <new>
#include <numeric>

#include "ply_text.h"

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

TEST(PlyDamage, HeadersThatLieAreRefusedBeforeMemoryIsTaken) {
  for (const Format format : kFormats) {
    for (const std::string count : {"4000000000", "99999999999999", "18446744073709551615"}) {
      const std::string vertices = Ply(format, "element vertex " + count + "\n" + kXyz).row(1.F, 2.F, 3.F).text();
      const std::string faces = Ply(format, "element vertex 1\n" + kXyz + "element face " + count + "\n" + kList)
                                    .row(1.F, 2.F, 3.F)
                                    .row(U8{3}, 0, 0, 0)
                                    .text();
      const std::string lists =
          Ply(format, "element other " + count + "\nproperty list uint double l\nelement vertex 0\n" + kXyz)
              .row(4000000000U, 1.0)
              .text();
      const std::string strip =
          Ply(format, "element vertex 1\n" + kXyz + "element tristrips 1\nproperty list uint int vertex_indices\n")
              .row(1.F, 2.F, 3.F)
              .row(4000000000U, 0, 0, 0)
              .text();
      for (const std::string& text : {vertices, faces, lists, strip}) {
        largest_request = 0;
        EXPECT_NE(error_of(text), "no error");
        EXPECT_LT(largest_request, 20000U) << text;
      }
    }
  }
}

/// Something of everything: lists that are passed over, faces before vertices, strips, values of many types.
Ply everything(Format format) {
  Ply ply(format, "comment c\nelement other 2\nproperty list ushort double l\nelement face 2\nproperty short s\n" +
                      kList + "element tristrips 1\nproperty list int int vertex_indices\nelement vertex 4\n" +
                      "property double x\nproperty uchar y\nproperty list uchar float l\nproperty float z\n");
  ply.row(uint16_t{1}, 0.5).row(uint16_t{0}).row(int16_t{1}, U8{3}, 0, 1, 2).row(int16_t{1}, U8{4}, 0, 1, 2, 3);
  ply.row(8, 0, 1, 2, 3, -1, 1, 2, 3);
  for (int i = 0; i < 3; ++i) ply.row(1.5, U8{1}, U8{0}, 1.F);
  return ply.row(1.5, U8{1}, U8{2}, 1.F, 2.F, 7.F);
}

TEST(PlyDamage, EveryCutIsAnError) {
  for (const Format format : kFormats) {
    for (const std::string& text : {square(format).text(), everything(format).text()}) {
      EXPECT_EQ(error_of(text), "no error");
      // The last number of an ascii file may lose digits, and the line its end, and still be right.
      const size_t end = format == Format::ascii ? text.rfind(' ') + 2 : text.size();
      for (size_t size = 0; size < end; ++size) EXPECT_NE(error_of(text.substr(0, size)), "no error") << size;
      for (size_t size = end; size < text.size(); ++size) EXPECT_EQ(error_of(text.substr(0, size)), "no error");
    }
  }
}

/// Parses the text with each byte replaced by each of `bytes`, and returns how many of these loaded.
size_t load_damaged(const std::string& text, const std::vector<int>& bytes) {
  size_t loaded = 0;
  for (size_t at = 0; at < text.size(); ++at) {
    for (const int byte : bytes) {
      std::string damaged = text;
      damaged[at] = static_cast<char>(byte);
      try {
        const Mesh mesh = parse(damaged);
        ++loaded;
        for (const Triangle& triangle : mesh.triangles) {
          EXPECT_LT(std::max({triangle[0], triangle[1], triangle[2]}), mesh.vertices.size());
        }
      } catch (const Error&) {
      }
    }
  }
  return loaded;
}

TEST(PlyDamage, NoDamagedByteDoesHarm) {
  std::vector<int> all(256);
  std::iota(all.begin(), all.end(), 0);
  largest_request = 0;
  for (const Format format : kFormats) {
    const std::string text = square(format).text();
    EXPECT_GT(load_damaged(text, all), text.size());  // each byte once as it was, at least
    EXPECT_GT(load_damaged(everything(format).text(), {0, 1, 0x7F, 0x80, 0xFF, '0', '9', '-', ' ', '\n', 'e'}), 0U);
  }
  EXPECT_LT(largest_request, 20000U);
}

}  // namespace
}  // namespace kerf::test
