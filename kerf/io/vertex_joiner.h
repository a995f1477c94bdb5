#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kerf/base/vec3.h"

namespace kerf {

/// Gives equal vertices one number, in the order in which they come. Minus zero becomes zero; of those that are not
/// numbers the same bits are the same vertex.
class VertexJoiner {
 public:
  /// `name` is the place of errors.
  explicit VertexJoiner(const std::string& name) : slots_(kFirstSlots, kFree), name_(name) {}

  /// The number of the vertex. Throws Error (too_large) for more than 2^32 - 1 different ones.
  uint32_t number(Vec3f vertex);

  /// All vertices by their numbers; ends the use of this object.
  std::vector<Vec3f> take() { return std::move(vertices_); }

 private:
  static constexpr uint32_t kFree = 0xFFFFFFFFU;
  static constexpr size_t kFirstSlots = 1024;

  void grow();

  std::vector<Vec3f> vertices_;
  std::vector<uint32_t> slots_;  // numbers of vertices by their hashes; a power of two, at most half of them taken
  const std::string& name_;
};

}  // namespace kerf
