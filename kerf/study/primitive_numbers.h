#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "kerf/geometry/geometry.h"
#include "kerf/tree/bvh.h"

namespace kerf {

/// Numbers all primitives of a scene in one row: by geometry, then primitive.
class PrimitiveNumbers {
 public:
  explicit PrimitiveNumbers(std::span<const Geometry> geometries) {
    for (const Geometry& geometry : geometries) {
      first_.push_back(size_);
      size_ += primitive_count(geometry);
    }
  }

  size_t size() const { return size_; }
  size_t number(const LeafSlot& slot) const { return first_[slot.geometry()] + slot.primitive; }
  LeafSlot slot(size_t number) const {
    const auto geometry =
        static_cast<size_t>(std::upper_bound(first_.begin(), first_.end(), number) - first_.begin()) - 1;
    return {static_cast<uint32_t>(geometry), static_cast<uint32_t>(number - first_[geometry])};
  }

 private:
  std::vector<size_t> first_;  // of each geometry
  size_t size_ = 0;
};

}  // namespace kerf
