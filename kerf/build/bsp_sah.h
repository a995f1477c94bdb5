#pragma once

#include <vector>

#include "kerf/base/options.h"
#include "kerf/base/work_limit.h"
#include "kerf/references/reference.h"
#include "kerf/tree/bsp_tree.h"

namespace kerf {

/// How a BspTree is built.
struct BspOptions {
  uint32_t max_depth = kMaxDepth;
  uint32_t faces = 8;         ///< planes of primitives tried in a cell, at most: those of the largest pieces
  uint32_t slices = 32;       ///< of a cell with many pieces; planes across each axis between them are tried
  double cap = 8;             ///< references for each primitive on average, never passed
  double axis_cost = 1;       ///< of meeting a plane across an axis, against primitive_cost for a primitive test
  double oblique_cost = 1.5;  ///< of meeting any other plane
  double primitive_cost = 1.5;

  static constexpr OptionSpec kSpecs[] = {
      {"depth", "depth of the tree, at most", kMaxDepth, 1, kMaxDepth, true},
      {"faces", "planes of primitives tried in a cell, at most", 8, 0, 1024, true},
      {"slices", "slices along each axis of a cell with many pieces; the planes between them are tried", 32, 2, 256,
       true},
      {"cap", "references per primitive, on average, that are never passed", 8, 1, 1000},
      {"axis_cost", "cost of meeting a plane across an axis", 1, 0},
      {"oblique_cost", "cost of meeting any other plane", 1.5, 0},
      {"primitive_cost", "cost of testing a primitive", 1.5, 0, 1e30, false, true},
  };
  static BspOptions from(const OptionValues& values);
};

/// A binary space partition by the surface area heuristic over convex cells (MacDonald and Booth 1990; the planes and
/// the cost of cells: Kammaje and Mora: A Study of Restricted BSP Trees for Ray Tracing, 2007; Ize, Wald and Parker:
/// Ray Tracing with the BSP Tree, 2008). In each cell the planes tried are those across the axes at the sides of the
/// pieces (between slices, where there are many pieces) and those of the largest pieces' primitives; the cheapest by
/// the areas of both parts is taken, unless a leaf is cheaper. Pieces are clipped to their cells. The references, one
/// for each whole primitive, share the cap by their number: a cell passes its share on to its parts, what they need to
/// each and the rest by area times count, so none is dropped and no order matters. Parallel; the outcome does not
/// depend on the number of threads. Throws Error(stopped) at the limit.
BspTree build_bsp_sah(std::span<const Geometry> geometries, const std::vector<Reference>& references,
                      const BspOptions& options = {}, const WorkLimit& limit = {});

}  // namespace kerf
