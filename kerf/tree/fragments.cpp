#include "kerf/tree/fragments.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "kerf/base/parallel.h"
#include "kerf/base/work_limit.h"

namespace kerf {

Fragments::Fragments(const Bvh& bvh, std::span<const Geometry> geometries, size_t primitives)
    : is_split_(static_cast<double>(bvh.slots.size()) > kSplit * static_cast<double>(primitives)) {
  const auto is_repeated = [](const LeafSlot& slot) { return slot.is_repeated(); };
  if (std::none_of(bvh.slots.begin(), bvh.slots.end(), is_repeated)) return;
  constexpr size_t kGrain = 4096;  // nodes
  std::vector<std::vector<FragmentCorner>> blocks((bvh.nodes.size() + kGrain - 1) / kGrain);
  const auto for_repeated = [&](size_t block, auto&& f) {
    const size_t begin = block * kGrain, end = std::min(begin + kGrain, bvh.nodes.size());
    for (const BvhNode& node : std::span(bvh.nodes).subspan(begin, end - begin)) {
      for (uint32_t i = node.first; node.is_leaf() && i < node.first + node.count; ++i) {
        if (bvh.slots[i].is_repeated()) f(i, bvh.slots[i], node.bounds());
      }
    }
  };
  HeldBytes held(bvh.slots.size() * sizeof(uint64_t));
  places_.resize(bvh.slots.size());
  parallel_for(blocks.size(), 1, [&](size_t block, size_t) {
    for_repeated(block, [&](uint32_t number, const LeafSlot& slot, const Box3f& cell) {
      std::array<FragmentCorner, kMaxFragmentCorners> corners;
      const size_t count = cut_fragment(geometries[slot.geometry()], slot.primitive, cell, corners);
      places_[number] = blocks[block].size() * kPerCount + count;
      blocks[block].insert(blocks[block].end(), corners.begin(), corners.begin() + count);
    });
    held.add(blocks[block].capacity() * sizeof(FragmentCorner));
  });
  std::vector<size_t> first(blocks.size() + 1);
  for (size_t i = 0; i < blocks.size(); ++i) first[i + 1] = first[i] + blocks[i].size();
  held.add(first.back() * sizeof(FragmentCorner));
  corners_.resize(first.back());
  parallel_for(blocks.size(), 1, [&](size_t block, size_t) {
    std::copy(blocks[block].begin(), blocks[block].end(), corners_.begin() + static_cast<ptrdiff_t>(first[block]));
    for_repeated(block,
                 [&](uint32_t number, const LeafSlot&, const Box3f&) { places_[number] += first[block] * kPerCount; });
  });
}

double parts_area(const Bvh& bvh, const LeafParts& parts) {
  constexpr size_t kGrain = 8192;  // slots
  std::vector<double> blocks((bvh.slots.size() + kGrain - 1) / kGrain);
  parallel_for(bvh.slots.size(), kGrain,
               [&](size_t begin, size_t end) { blocks[begin / kGrain] = parts(begin, end - begin).area; });
  return std::accumulate(blocks.begin(), blocks.end(), 0.0);
}

}  // namespace kerf
