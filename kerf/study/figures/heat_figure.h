#pragma once

#include <span>
#include <string>
#include <vector>

#include "kerf/io/scene_description.h"
#include "kerf/study/figures/drawing.h"
#include "kerf/study/figures/figure_work.h"

namespace kerf {

/// What the rays of a picture cost in one structure.
struct HeatRow {
  std::string row;         ///< the pipeline
  Image nodes, triangles;  ///< visited nodes and primitive tests of each pixel's ray
  double nodes_per_ray = 0, triangles_per_ray = 0;
};

/// Builds each pipeline and traces a ray through the centre of each pixel. Throws Error as build_scene() and
/// CameraRays do, and Error (stopped).
std::vector<HeatRow> trace_heat(const SceneDescription& scene, const Camera& camera, std::span<const std::string> rows,
                                const FigureOptions& options);

/// The numbers that the two ends of the colours stand for.
struct HeatScale {
  double least = 0, most = 1;
  bool is_clipped = false;  ///< some pixels are above `most`, and look like it

  double place(double value) const { return (value - least) / (most - least); }
};
/// From 0 to the largest value of all images; where a few pixels in a thousand lie far above all others, to the
/// largest of those others. One scale for all images, so that they can be compared.
HeatScale heat_scale(std::span<const Image* const> images);

/// Heat maps of nodes (above) and triangles per ray (below), side by side for all rows: a legend for each of the two,
/// captions with the pipeline and the means.
Drawing heat_figure(std::span<const HeatRow> rows);

}  // namespace kerf
