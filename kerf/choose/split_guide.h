#pragma once

#include <array>
#include <vector>

#include "kerf/base/work_limit.h"
#include "kerf/references/clipper.h"

namespace kerf {

/// A reference on its way through the guide. 48 bytes.
struct GuidedReference {
  Reference reference;
  uint32_t place = 0;  ///< of the whole reference that it is, or is a piece of
  /// How many references it stands for where planes are judged; 0: it is cut where others say, and has no say itself.
  float weight = 0;
  bool is_settled = false;  ///< not to be cut in the middle again: that saves too little of it
};

/// What cutting saves, by how much each new reference saves: bucket i holds cuts with a gain of 2^(kFirst + i) and
/// more.
struct GainCurve {
  static constexpr int kFirst = -8, kBuckets = 24;
  struct Bucket {
    size_t references = 0;  ///< new ones
    double saved = 0;       ///< of the boxes' half area
  };
  std::array<Bucket, kBuckets> buckets;

  void add(double gain, double saved, size_t references);
  void add(const GainCurve& other);
};

/// How far the guide goes.
struct GuideRules {
  /// A cut within a cell must save this share of the predicted cost for each share of references that it adds: gains
  /// below are not worth the memory. Of the cell's own cost, and of the whole scene's; one of them is enough.
  double cell_gain = 0.4, scene_gain = 0.25;
  /// A plane through references must save this share of the node's cost for each share of references that it adds.
  double plane_gain = 0;
  /// The half area that one reference may save before it is worth a cut, at a gain of 1: predicted cost of the scene /
  /// references, times the half area of the scene's box.
  double scene_unit = 0;
  double most_growth = 8;  ///< pieces for each reference, at most, on average
};

/// What came of it.
struct GuidedPieces {
  std::vector<std::vector<GuidedReference>> cells;
  GainCurve curve;  ///< of the cuts in cells
};

/// Cuts large references where a coarse tree over them would: from the top down each node takes the cheapest of some
/// planes between references and some through them (Stich, Friedrich, Dietrich: Spatial Splits in Bounding Volume
/// Hierarchies, 2009), as a guide for cutting before a tree is built (Ganestam, Doggett: SAH Guided Spatial Split
/// Partitioning for Fast BVH Construction, 2016). Planes are judged by the references with a weight alone. In the cells
/// where the guide ends, what is still large for its cell is cut in the middle of its longest side, as long as that
/// saves enough. Parallel; the outcome does not depend on the number of threads. Throws Error(stopped).
GuidedPieces guide_splits(std::vector<GuidedReference> references, std::span<const Geometry> geometries,
                          const Clipper& clipper, const GuideRules& rules, const WorkLimit& limit);

}  // namespace kerf
