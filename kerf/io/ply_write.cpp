#include "kerf/io/ply_write.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include "kerf/base/error.h"
#include "kerf/base/letter_case.h"
#include "kerf/io/byte_order.h"
#include "kerf/io/output_file.h"

namespace kerf {
namespace {

constexpr std::string_view kExtension = ".ply";
constexpr size_t kChunk = 1 << 15;  // rows that are put together before they go to the file

char* put(char* to, uint32_t bits) {
  if constexpr (!kLittleEndianHost) bits = __builtin_bswap32(bits);
  std::memcpy(to, &bits, sizeof bits);
  return to + sizeof bits;
}

/// Writes `count` rows of `size` bytes each; fill(to, i) writes one and returns its end.
template <class Fill>
void write_rows(OutputFile& file, size_t count, size_t size, Fill&& fill) {
  std::string bytes(std::min(count, kChunk) * size, '\0');
  for (size_t begin = 0; begin < count; begin += kChunk) {
    char* to = bytes.data();
    for (size_t i = begin; i < std::min(begin + kChunk, count); ++i) to = fill(to, i);
    file.write({bytes.data(), to});
  }
}

}  // namespace

void check_ply_name(const std::string& path) {
  const size_t stem = path.size() < kExtension.size() ? 0 : path.size() - kExtension.size();
  if (!equals_ignoring_case(std::string_view(path).substr(stem), kExtension)) {
    throw Error(ErrorCode::invalid_option, path, "models are written as PLY; give it a name that ends in .ply");
  }
}

void write_ply(const std::string& path, const Mesh& mesh) {
  if (mesh.vertices.size() > std::numeric_limits<int32_t>::max()) {
    throw Error(ErrorCode::too_large, path, "a PLY file numbers at most 2^31 - 1 vertices");
  }
  OutputFile file(path);
  file.write(
      fmt::format("ply\nformat binary_little_endian 1.0\n"
                  "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
                  "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                  mesh.vertices.size(), mesh.triangles.size()));
  write_rows(file, mesh.vertices.size(), 3 * sizeof(uint32_t), [&](char* to, size_t i) {
    const Vec3f v = mesh.vertices[i];
    for (const float x : {v.x, v.y, v.z}) to = put(to, std::bit_cast<uint32_t>(x));
    return to;
  });
  write_rows(file, mesh.triangles.size(), 1 + 3 * sizeof(uint32_t), [&](char* to, size_t i) {
    *to++ = 3;
    for (const uint32_t corner : mesh.triangles[i]) to = put(to, corner);
    return to;
  });
  file.commit();
}

}  // namespace kerf
