#pragma once

#include <limits>
#include <span>

#include "kerf/choose/split_guide.h"

namespace kerf {

/// A plane across a node of the guide, and what would lie on either side of it.
struct GuidePlane {
  static constexpr uint32_t kBins = 16;  // slices of a node along each axis; planes lie between them

  double cost = std::numeric_limits<double>::infinity();  ///< half area times references, both sides added
  uint32_t axis = 0;
  bool cuts = false;           ///< goes through references; else it divides them by their centres
  float position = 0;          ///< of one that cuts
  uint32_t bin = 0;            ///< of one that does not: the first bin of centres above it
  float first = 0, scale = 0;  ///< of those bins
  Box3f below, above;
  double below_weight = 0, above_weight = 0;

  bool exists() const { return cost < std::numeric_limits<double>::infinity(); }
  /// For a plane that does not cut: whether a reference belongs to its lower side.
  bool is_below(const Reference& reference) const;
};

/// A node of the guide.
struct GuideNode {
  Box3f bounds;   ///< of all
  Box3f centers;  ///< of lower + upper of those with a weight
  double weight = 0;
  size_t weighty = 0;  ///< references with a weight

  explicit GuideNode(std::span<const GuidedReference> references);
};

/// The cheapest plane that cuts nothing (Wald 2007); none if all centres are in one place.
GuidePlane cheapest_dividing_plane(std::span<const GuidedReference> references, const GuideNode& node);

/// The cheapest plane through the node's box, with references on both sides where it cuts them (Stich et al. 2009).
GuidePlane cheapest_cutting_plane(std::span<const GuidedReference> references, const GuideNode& node,
                                  std::span<const Geometry> geometries);

}  // namespace kerf
