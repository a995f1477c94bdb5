#pragma once

#include <string>
#include <vector>

#include "kerf/scene/scene.h"

namespace kerf {

/// A box of a structure, or one that a builder is given.
struct TreeBox {
  /// What `owner` is of a box without primitives, and of one with several.
  static constexpr uint32_t kNobody = kNone, kSeveral = kNone - 1;

  Box3f bounds;
  uint32_t depth = 0;
  bool is_leaf = true;
  uint32_t owner = kNobody;  ///< the one primitive that it is of: its number over all geometries

  bool is_of_one() const { return owner < kSeveral; }
};

/// All boxes of a scene's structure, as Structure::visit_nodes() gives them.
std::vector<TreeBox> tree_boxes(const Scene& scene);

/// The boxes that the pipeline's builder is given: of whole primitives, or of what a splitter makes of them.
std::vector<TreeBox> input_boxes(const Scene& scene, const std::string& pipeline);

/// The nodes of one level, and the leaves above it: together they hold everything.
std::vector<TreeBox> level_of(const std::vector<TreeBox>& boxes, uint32_t depth);

/// The leaves that hold something.
std::vector<TreeBox> filled_leaves(const std::vector<TreeBox>& boxes);

/// The boxes of the largest surface area, at most `count`, in their order; the earlier of equal ones.
std::vector<TreeBox> largest_boxes(std::vector<TreeBox> boxes, size_t count);

}  // namespace kerf
