#include "kerf/tree/cell_slots.h"

#include <cstring>

#include "kerf/base/mix.h"
#include "kerf/base/parallel.h"

namespace kerf {
namespace {

/// How often each primitive stands in the slots, by geometry's first number + primitive; 2 stands for more.
class SlotCounts {
 public:
  explicit SlotCounts(std::span<const Geometry> geometries) {
    size_t total = 0;
    for (const Geometry& geometry : geometries) {
      first_.push_back(total);
      total += primitive_count(geometry);
    }
    count_.resize(total);
  }
  void add(std::span<const LeafSlot> slots) {
    for (const LeafSlot& slot : slots) {
      uint8_t& seen = count_[first_[slot.geometry()] + slot.primitive];
      if (seen < 2) ++seen;
    }
  }
  uint8_t of(uint32_t geometry, uint32_t primitive) const { return count_[first_[geometry] + primitive]; }

 private:
  std::vector<size_t> first_;
  std::vector<uint8_t> count_;
};

uint64_t add_word(uint64_t state, uint64_t word) { return mix(state + 0x9E3779B97F4A7C15U + word); }

}  // namespace

void mark_repeated(std::span<LeafSlot> slots, std::span<const Geometry> geometries) {
  for (LeafSlot& slot : slots) slot.geometry_bits = slot.geometry();
  SlotCounts counts(geometries);
  counts.add(slots);
  for (LeafSlot& slot : slots) {
    if (counts.of(slot.geometry(), slot.primitive) > 1) slot.geometry_bits |= LeafSlot::kRepeated;
  }
}

std::optional<std::string> find_slot_fault(std::span<const LeafSlot> slots, std::span<const Geometry> geometries) {
  for (size_t i = 0; i < slots.size(); ++i) {
    const LeafSlot& slot = slots[i];
    if (slot.geometry() >= geometries.size() || slot.primitive >= primitive_count(geometries[slot.geometry()])) {
      return "slot " + std::to_string(i) + " names no primitive";
    }
  }
  SlotCounts counts(geometries);
  counts.add(slots);
  for (size_t i = 0; i < slots.size(); ++i) {
    if ((counts.of(slots[i].geometry(), slots[i].primitive) > 1) != slots[i].is_repeated()) {
      return "slot " + std::to_string(i) + " has the wrong repeat mark";
    }
  }
  for (uint32_t g = 0; g < geometries.size(); ++g) {
    for (uint32_t p = 0; p < primitive_count(geometries[g]); ++p) {
      if (counts.of(g, p) > 0 || find_defect(geometries[g], p) != Defect::none) continue;
      if (!is_degenerate(geometries[g], p)) {
        return "geometry " + std::to_string(g) + ", primitive " + std::to_string(p) + " is in no slot";
      }
    }
  }
  return std::nullopt;
}

uint64_t word_hash(std::span<const uint32_t> words, uint64_t seed) {
  // Blocks of fixed size, so that they can be hashed in parallel, and their hashes in order.
  constexpr size_t kGrain = size_t{1} << 18;
  std::vector<uint64_t> blocks((words.size() + kGrain - 1) / kGrain);
  parallel_for(words.size(), kGrain, [&](size_t begin, size_t end) {
    uint64_t state = 0;
    for (size_t i = begin; i < end; ++i) state = add_word(state, words[i]);
    blocks[begin / kGrain] = state;
  });
  uint64_t state = add_word(seed, words.size());
  for (const uint64_t block : blocks) state = add_word(state, block);
  return state;
}

}  // namespace kerf
