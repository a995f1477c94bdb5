#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kerf/references/reference.h"

namespace kerf {

/// Parts of a tree that wait to be joined, in the order of the curve that their centres lie on: their boxes, one vector
/// for each side so that several are computed at once, and their numbers.
class Clusters {
 public:
  /// The farthest that find_partners() looks.
  static constexpr uint32_t kMostRadius = 256;
  /// Of one cluster.
  static constexpr size_t kBytes = 6 * sizeof(float) + sizeof(uint32_t);

  Clusters() = default;
  /// One for each reference. Boxes are kept in units of the box around all: areas then neither overflow nor vanish.
  explicit Clusters(std::span<const Reference> references);

  size_t size() const { return numbers_.size(); }
  void resize(size_t size);
  uint32_t number(size_t i) const { return numbers_[i]; }

  /// Sets cluster i to one of others, or to the union of two with a number of its own.
  void set(size_t i, const Clusters& from, size_t one);
  void set_joined(size_t i, const Clusters& from, size_t one, size_t other, uint32_t number);

  /// For each cluster the one, at most `radius` places away, with which the box around both has the least area. Ties
  /// are broken by a rule on pairs, which has two properties: some two clusters always choose each other, and in a row
  /// of equal boxes all do. First come the pairs of an even place and the next, then those less far apart, then those
  /// with the lower places. A single cluster is its own. Parallel.
  void find_partners(uint32_t radius, std::vector<uint32_t>& partners) const;

 private:
  static constexpr size_t kSides = 6;   // three lower, three upper
  static constexpr size_t kTile = 512;  // clusters looked at together: what they need stays in the nearest cache

  void find_partners(size_t begin, size_t end, uint32_t radius, uint32_t* partners) const;
  void areas(size_t begin, size_t end, size_t distance, float* out) const;

  std::array<std::vector<float>, kSides> sides_;
  std::vector<uint32_t> numbers_;
};

}  // namespace kerf
