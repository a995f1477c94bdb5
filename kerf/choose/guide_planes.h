#pragma once

#include <limits>
#include <span>
#include <vector>

#include "kerf/references/clipper.h"

namespace kerf {

/// The references that planes of the guide are judged by, each for as many as its weight says, a whole number.
struct Judges {
  std::vector<Reference> references;
  std::vector<float> weights;
  std::vector<Box3f> others;  ///< of references that have no say, but show how far a node reaches

  size_t size() const { return references.size(); }
  bool empty() const { return references.empty(); }
  void add(const Reference& reference, float weight) {
    references.push_back(reference);
    weights.push_back(weight);
  }
};

/// What judges span.
struct JudgedBox {
  Box3f bounds;
  Box3f centers;  ///< of lower + upper
  Box3f all;      ///< bounds, and the others
  double weight = 0;

  explicit JudgedBox(const Judges& judges);
};

/// A plane across a node of the guide, and what the judges say lies on either side of it.
struct GuidePlane {
  static constexpr uint32_t kBins = 16;  // slices of a node along each axis; planes lie between them
  enum class Side : uint8_t { below, above, both };

  double cost = std::numeric_limits<double>::infinity();  ///< half area times references, both sides added
  double toll = 0;    ///< of the same kind, for each reference more: what a cut must save in any case
  bool cuts = false;  ///< goes through references; else it divides them by their centres
  uint32_t axis = 0;
  float position = 0;          ///< of one that cuts
  uint32_t bin = 0;            ///< of one that does not: the first bin of centres above it
  float first = 0, scale = 0;  ///< of those bins
  Box3f below, above;
  double below_weight = 0, above_weight = 0;

  bool exists() const { return cost < std::numeric_limits<double>::infinity(); }
  /// Where the box of a reference belongs. One across a plane that cuts belongs to both sides, or whole to one where
  /// that is cheaper (Stich et al. 2009, section 4.4, with the sides as they were judged).
  Side side_of(const Box3f& reference, double weight) const;
};

/// The cheapest plane that cuts nothing (Wald 2007); none if all centres are in one place.
GuidePlane cheapest_dividing_plane(const Judges& judges, const JudgedBox& box);

/// The cheapest plane through the box, with references on both sides where it cuts them (Stich et al. 2009); none if
/// all cost at least `cost`.
GuidePlane cheapest_cutting_plane(const Judges& judges, const JudgedBox& box, const Clipper& clipper, double cost);

}  // namespace kerf
