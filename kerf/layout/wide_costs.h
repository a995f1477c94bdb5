#pragma once

namespace kerf {

/// What visiting takes, for the collapse of a binary tree: in time of a node of any width.
struct WideCosts {
  double node = 1;
  double leaf = 0.7;       ///< of triangles
  double triangle = 0.03;  ///< more for each of them
  double primitive = 0.8;  ///< for each primitive of a leaf of any
};

}  // namespace kerf
