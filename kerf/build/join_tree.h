#pragma once

#include <cstdint>
#include <vector>

#include "kerf/build/top_down.h"

namespace kerf {

/// Two parts of a tree that became one. A part is numbered as what it is: below the number of references, that
/// reference; else the join with the rest of the number. 16 bytes.
struct Join {
  uint32_t left = 0, right = 0;
  uint32_t references = 0;  ///< below it
  uint32_t nodes = 0;       ///< below it in the Bvh; 0: it is a leaf. Set by make_bvh()
};

/// A binary tree with a leaf for each reference, of any depth: what builders that know no nodes leave behind.
struct JoinTree {
  std::vector<Reference> references;
  std::vector<Join> joins;  ///< one fewer than references
  uint32_t root = 0;
  HeldBytes held;

  /// Makes room for their joins.
  void take(std::vector<Reference> all) {
    references = std::move(all);
    held.set(references.size() * (sizeof(Reference) + sizeof(Join)));
    joins.resize(references.size() - 1);
  }
  bool is_join(uint32_t part) const { return part >= references.size(); }
  Join& join(uint32_t part) { return joins[part - references.size()]; }
  const Join& join(uint32_t part) const { return joins[part - references.size()]; }
  uint32_t reference_count(uint32_t part) const { return is_join(part) ? join(part).references : 1; }
  /// The number of a join.
  uint32_t part(size_t join) const { return static_cast<uint32_t>(references.size() + join); }
};

/// What a builder that ends in make_bvh() takes for each reference at its peak, when the Bvh is written.
inline constexpr size_t kJoinTreeBytes = sizeof(Reference) + sizeof(Join) + 2 * sizeof(BvhNode) + sizeof(LeafSlot);

/// The Bvh of a tree. From the bottom up, a join that the surface area heuristic finds cheaper as a leaf becomes one.
/// The depth bound is that of build_top_down(): a join with a part that would not fit in the levels that are left is
/// made anew of halves of equal counts, its references in the order they had. Takes, beside the tree, what the Bvh
/// takes. Throws as build_top_down() does. Parallel.
Bvh make_bvh(JoinTree tree, const TopDownOptions& options, const WorkLimit& limit);

}  // namespace kerf
