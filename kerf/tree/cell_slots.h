#pragma once

#include <optional>
#include <string>

#include "kerf/tree/bvh.h"

namespace kerf {

/// Sets LeafSlot::kRepeated where a primitive stands in more than one slot, and nowhere else.
void mark_repeated(std::span<LeafSlot> slots, std::span<const Geometry> geometries);

/// A slot that names no primitive or has the wrong kRepeated; or a primitive with an area that is in no slot.
std::optional<std::string> find_slot_fault(std::span<const LeafSlot> slots, std::span<const Geometry> geometries);

/// A number that is equal for equal words, whatever the machine. Parallel.
uint64_t word_hash(std::span<const uint32_t> words, uint64_t seed = 0);

/// The same for plain data that consists of words.
template <class T>
uint64_t data_hash(std::span<const T> data, uint64_t seed = 0) {
  static_assert(sizeof(T) % sizeof(uint32_t) == 0 && std::is_trivially_copyable_v<T>);
  return word_hash({reinterpret_cast<const uint32_t*>(data.data()), data.size_bytes() / sizeof(uint32_t)}, seed);
}

}  // namespace kerf
