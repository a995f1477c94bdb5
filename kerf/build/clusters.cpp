#include "kerf/build/clusters.h"

#include <algorithm>
#include <limits>

#include "kerf/base/parallel.h"
#include "kerf/references/box_around.h"

namespace kerf {
namespace {

constexpr size_t kGrain = 4096;

/// Moves and scales the box around all references to the unit cube.
struct UnitBox {
  Vec3d first;
  double scale = 0;

  explicit UnitBox(std::span<const Reference> references) {
    const Box3f all = box_around(references);
    first = to_double(all.lower);
    const double longest = largest(to_double(all.upper) - first);
    if (longest > 0) scale = 1 / longest;
  }
  float operator()(float x, uint32_t axis) const {
    return static_cast<float>((static_cast<double>(x) - first[axis]) * scale);
  }
};

constexpr float lesser(float a, float b) { return a < b ? a : b; }
constexpr float greater(float a, float b) { return a > b ? a : b; }

/// Where an area is less than the least so far, it takes its place. Without a branch, so that it is vectorized.
void offer(const float* __restrict areas, uint32_t offset, size_t count, float* __restrict least,
           uint32_t* __restrict offsets) {
  for (size_t i = 0; i < count; ++i) {
    const uint32_t is_less = areas[i] < least[i] ? ~0U : 0;
    least[i] = lesser(areas[i], least[i]);
    offsets[i] ^= (offsets[i] ^ offset) & is_less;
  }
}

}  // namespace

Clusters::Clusters(std::span<const Reference> references) {
  resize(references.size());
  const UnitBox unit(references);
  parallel_for(size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      for (uint32_t axis = 0; axis < 3; ++axis) {
        sides_[axis][i] = unit(references[i].lower[axis], axis);
        sides_[3 + axis][i] = unit(references[i].upper[axis], axis);
      }
      numbers_[i] = static_cast<uint32_t>(i);
    }
  });
}

void Clusters::resize(size_t size) {
  for (std::vector<float>& side : sides_) side.resize(size);
  numbers_.resize(size);
}

void Clusters::set(size_t i, const Clusters& from, size_t one) {
  for (size_t side = 0; side < kSides; ++side) sides_[side][i] = from.sides_[side][one];
  numbers_[i] = from.numbers_[one];
}

void Clusters::set_joined(size_t i, const Clusters& from, size_t one, size_t other, uint32_t number) {
  for (size_t axis = 0; axis < 3; ++axis) {
    const std::vector<float>&lower = from.sides_[axis], &upper = from.sides_[3 + axis];
    sides_[axis][i] = lesser(lower[one], lower[other]);
    sides_[3 + axis][i] = greater(upper[one], upper[other]);
  }
  numbers_[i] = number;
}

void Clusters::find_partners(uint32_t radius, std::vector<uint32_t>& partners) const {
  partners.resize(size());
  parallel_for(size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t tile = begin; tile < end; tile += kTile) {
      find_partners(tile, std::min(tile + kTile, end), radius, partners.data() + tile);
    }
  });
}

/// Half the area around clusters i and i + distance, for each i in [begin, end).
void Clusters::areas(size_t begin, size_t end, size_t distance, float* __restrict out) const {
  const auto side = [&](size_t number) { return sides_[number].data() + begin; };
  const float *x0 = side(0), *y0 = side(1), *z0 = side(2), *x1 = side(3), *y1 = side(4), *z1 = side(5);
  for (size_t i = 0, j = distance; i < end - begin; ++i, ++j) {
    const float x = greater(x1[i], x1[j]) - lesser(x0[i], x0[j]);
    const float y = greater(y1[i], y1[j]) - lesser(y0[i], y0[j]);
    const float z = greater(z1[i], z1[j]) - lesser(z0[i], z0[j]);
    out[i] = x * (y + z) + y * z;
  }
}

/// All pairs of one distance at a time; each area is looked at from both sides. The order of the offers is the rule for
/// ties, for only a lesser area takes the place of another.
void Clusters::find_partners(size_t begin, size_t end, uint32_t radius, uint32_t* partners) const {
  std::array<float, kTile> least;
  std::array<uint32_t, kTile> offset;  // to the partner; wraps around for one before
  std::array<float, kTile + kMostRadius> area;
  least.fill(std::numeric_limits<float>::infinity());
  offset.fill(0);
  const size_t count = end - begin;
  const auto farthest = static_cast<uint32_t>(std::min<size_t>(radius, size() - 1));
  for (uint32_t distance = 1; distance <= farthest; ++distance) {
    const size_t first = begin - std::min<size_t>(begin, distance), last = std::min(end, size() - distance);
    areas(first, last, distance, area.data());
    const float* own = area.data() + (begin - first);  // of the tile's first cluster and the one behind it
    if (distance == 1) {                               // tiles begin at even places
      for (size_t i = 0; i + 1 < count; i += 2) {
        least[i] = least[i + 1] = own[i];
        offset[i] = 1;
        offset[i + 1] = 0U - 1;
      }
    }
    const size_t lowest = first + distance - begin;  // the first that has one `distance` before it
    if (lowest < count) offer(area.data(), 0U - distance, count - lowest, &least[lowest], &offset[lowest]);
    if (last > begin) offer(own, distance, last - begin, least.data(), offset.data());
  }
  for (size_t i = 0; i < count; ++i) partners[i] = static_cast<uint32_t>(begin + i) + offset[i];
}

}  // namespace kerf
