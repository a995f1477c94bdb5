#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "kerf/base/thread_vector.h"
#include "kerf/base/work_limit.h"
#include "kerf/choose/guide_planes.h"

namespace kerf {

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
  double cell_gain = 2, scene_gain = 0.25;
  /// A plane through references must save this share of the node's cost for each share of references that it adds.
  double plane_gain = 0;
  /// The half area that one reference may save before it is worth a cut, at a gain of 1: predicted cost of the scene /
  /// references, times the half area of the scene's box.
  double scene_unit = 0;
  double most_growth = 8;  ///< pieces of each judge, at most, on average
};

/// Where to cut references: a coarse tree over some of them, the judges. From the top down each node takes the cheapest
/// of some planes between judges and some through them (Stich, Friedrich, Dietrich: Spatial Splits in Bounding Volume
/// Hierarchies, 2009), as a guide for cutting before a tree is built (Ganestam, Doggett: SAH Guided Spatial Split
/// Partitioning for Fast BVH Construction, 2016). In the cells where it ends, what is still large for its cell is cut
/// in the middle of its longest side, as long as that saves enough.
class SplitGuide {
 public:
  /// Parallel; the outcome does not depend on the number of threads. Throws Error(stopped).
  SplitGuide(Judges judges, const std::span<const Geometry>& geometries, const GuideRules& rules,
             const WorkLimit& limit);
  ~SplitGuide();

  /// Cuts a reference and hands its pieces to emit(piece), which returns false to stop early; what the cuts in cells
  /// save is added to `curve`.
  template <class Emit>
  void split(const Reference& whole, const Clipper& clipper, GainCurve& curve, Emit&& emit) const {
    ThreadVector<Waiting> reused;
    std::vector<Waiting>& stack = *reused;
    stack.push_back({whole, root_.get()});
    while (!stack.empty()) {
      const Waiting next = stack.back();
      stack.pop_back();
      const std::optional<Reference> piece = advance(next, clipper, stack, curve);
      if (piece && !emit(*piece)) return;
    }
  }

 private:
  struct Node;
  class Building;

  /// A piece on its way through the guide.
  struct Waiting {
    Reference reference;
    const Node* node;
  };

  /// Takes a piece down to where it is cut, and its parts wait there; or it is finished.
  std::optional<Reference> advance(const Waiting& piece, const Clipper& clipper, std::vector<Waiting>& stack,
                                   GainCurve& curve) const;

  double scene_saving_;  ///< half area that a cut must save by what the whole scene costs
  std::unique_ptr<const Node> root_;
};

}  // namespace kerf
