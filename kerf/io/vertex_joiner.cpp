#include "kerf/io/vertex_joiner.h"

#include <bit>

#include "kerf/base/error.h"

namespace kerf {
namespace {

/// Every bit of the coordinates has a say in the high half of the result; the last steps are the finalizer of
/// MurmurHash3 (Austin Appleby), which vertices on a grid do not defeat.
uint64_t hash(Vec3f vertex) {
  const uint64_t xy = uint64_t{std::bit_cast<uint32_t>(vertex.x)} << 32 | std::bit_cast<uint32_t>(vertex.y);
  uint64_t h = xy * 0x9E3779B97F4A7C15U;
  h = (h ^ h >> 32 ^ std::bit_cast<uint32_t>(vertex.z)) * 0xFF51AFD7ED558CCDU;
  h = (h ^ h >> 33) * 0xC4CEB9FE1A85EC53U;
  return h ^ h >> 33;
}

bool equal_bits(Vec3f a, Vec3f b) {
  return std::bit_cast<uint32_t>(a.x) == std::bit_cast<uint32_t>(b.x) &&
         std::bit_cast<uint32_t>(a.y) == std::bit_cast<uint32_t>(b.y) &&
         std::bit_cast<uint32_t>(a.z) == std::bit_cast<uint32_t>(b.z);
}

}  // namespace

uint32_t VertexJoiner::number(Vec3f vertex) {
  vertex = vertex + Vec3f{0, 0, 0};  // makes zero of minus zero
  const size_t mask = slots_.size() - 1;
  size_t slot = hash(vertex) & mask;
  for (; slots_[slot] != kFree; slot = (slot + 1) & mask) {
    if (equal_bits(vertices_[slots_[slot]], vertex)) return slots_[slot];
  }
  if (vertices_.size() == kFree) {
    throw Error(ErrorCode::too_large, name_, "more than 2^32 - 1 different vertices");
  }
  const auto number = static_cast<uint32_t>(vertices_.size());
  slots_[slot] = number;
  vertices_.push_back(vertex);
  if (vertices_.size() > slots_.size() / 2) grow();
  return number;
}

void VertexJoiner::grow() {
  slots_.assign(slots_.size() * 4, kFree);
  const size_t mask = slots_.size() - 1;
  for (size_t i = 0; i < vertices_.size(); ++i) {
    size_t slot = hash(vertices_[i]) & mask;
    while (slots_[slot] != kFree) slot = (slot + 1) & mask;
    slots_[slot] = static_cast<uint32_t>(i);
  }
}

}  // namespace kerf
