#pragma once

#include <array>
#include <unordered_map>

#include "kerf/geometry/shapes.h"

namespace kerf {

/// Numbers the places of corners and the sides between them from 0: equal places are one, however many vertices lie
/// there.
class WeldedSides {
 public:
  struct Numbers {
    std::array<uint32_t, 3> places;
    std::array<uint32_t, 3> sides;  ///< from corner 0 to 1, 1 to 2 and 2 to 0
  };

  Numbers add(const Triangle& triangle);

  size_t side_count() const { return sides_.size(); }

 private:
  struct Hash {
    size_t operator()(const std::array<uint32_t, 3>& bits) const;
    size_t operator()(uint64_t bits) const;
  };

  std::unordered_map<std::array<uint32_t, 3>, uint32_t, Hash> places_;
  std::unordered_map<uint64_t, uint32_t, Hash> sides_;
};

}  // namespace kerf
