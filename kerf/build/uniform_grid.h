#pragma once

#include "kerf/base/work_limit.h"
#include "kerf/references/clipper.h"
#include "kerf/tree/uniform_grid.h"

namespace kerf {

/// How a uniform grid is built.
struct UniformGridOptions {
  double density = 4;   ///< cells for each reference, about
  double cap = 16;      ///< slots for each reference, at most
  bool clipped = true;  ///< cells get what reaches into them; else what has a box that does
};

/// Divides the references' box into cells (Fujimoto, Tanaka, Iwata: ARTS: Accelerated Ray-Tracing System, 1986), as
/// many as `density` says (Cleary, Wyvill: Analysis of an Algorithm for Fast Ray Tracing Using Uniform Space
/// Subdivision, 1988). Where they would take more slots than `cap` allows, the grid is made coarser, by half the cells
/// at a time. The same grid for any number of threads. LeafSlot::kRepeated is not set.
/// Throws Error(stopped) at the limit.
UniformGrid build_uniform_grid(std::span<const Reference> references, const Clipper& clipper,
                               const UniformGridOptions& options, const WorkLimit& limit = {});

}  // namespace kerf
