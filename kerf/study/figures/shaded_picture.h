#pragma once

#include "kerf/scene/scene.h"
#include "kerf/study/figures/figure_work.h"
#include "kerf/study/figures/projection.h"

namespace kerf {

/// The width of wires in pixels that looks right in print and on screens.
inline constexpr double kWireWidth = 1.2;

struct ShadedOptions {
  uint32_t width = 960, height = 640;
  uint32_t samples = 4;   ///< rays of each pixel, in each direction: 4 are 16 rays
  double line_width = 0;  ///< of primitives' edges, in pixels; 0: no edges
  int threads = 0;
  FigureProgress progress;
};

/// What a camera sees, each primitive in one shade, on white, smoothed by several rays a pixel; with line_width the
/// edges of triangles and parallelograms are drawn on it, hidden ones not. Where edges would lie closer than they are
/// wide, they are fainter, so that a fine mesh does not become a black one. The same for any number of threads. Throws
/// Error as CameraRays does, and Error (stopped).
Image shaded_picture(const Scene& scene, const Camera& camera, const ShadedOptions& options);

/// Wireframe on shaded, as in Figure 3 of Ernst and Greiner 2007.
Image wireframe_picture(const Scene& scene, const Camera& camera, uint32_t width, uint32_t height, int threads = 0);

/// How far what is seen through the centre of each pixel is from the eye; infinite where nothing is.
Image distance_picture(const Scene& scene, const Camera& camera, const ShadedOptions& options);

}  // namespace kerf
