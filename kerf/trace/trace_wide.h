#pragma once

#include <span>
#include <string_view>

#include "kerf/layout/quantised_bvh.h"
#include "kerf/layout/wide_bvh.h"
#include "kerf/trace/trace_table.h"

namespace kerf {

/// A WideBvh or QuantisedBvh and what its slots name: what the kernels work on.
template <class Layout>
struct WideTracer {
  Layout layout;
  std::span<const Geometry> geometries;
  float largest_coordinate = 0;  ///< of the layout's bounds
  uint32_t shared_mask = 0;      ///< what the masks of all geometries have in common

  /// To be called when the layout is made or its bounds have changed.
  void update();
};

/// What one instruction set offers.
struct WideKernels {
  const TraceTable* table;           ///< its data is a WideTracer
  std::string_view instruction_set;  ///< its name
};

/// The kernels for the chosen_instruction_set(), whose errors it throws; to be asked once, not for each ray. Hits are
/// the same bits for all.
template <class Layout>
WideKernels wide_kernels();

}  // namespace kerf
