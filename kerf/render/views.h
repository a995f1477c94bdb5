#pragma once

#include <functional>
#include <span>
#include <string_view>

#include "kerf/io/image.h"
#include "kerf/render/camera.h"
#include "kerf/scene/scene.h"

namespace kerf {

/// What a debug view shows of the nearest hit of each pixel's ray.
enum class View { depth, primitive, normal, uv, nodes, triangles };

struct ViewEntry {
  View view;
  std::string_view name;
  std::string_view sentence;
  uint32_t channels;
};

/// All views, by name.
std::span<const ViewEntry> views();

struct ViewOptions {
  View view = View::depth;
  uint32_t width = 960, height = 640;
  int threads = 0;
  /// Called now and then from one thread at a time with the share that is done; returns false to stop.
  std::function<bool(double)> progress;
};

/// The values of a view, and what they cost.
struct ViewResult {
  Image values;          ///< depth: t, infinite for none; primitive: its number, -1 for none; normal; u, v, 0; counts
  bool complete = true;  ///< false if progress() stopped it; the pixels not reached show nothing hit
  uint64_t rays = 0, hits = 0;
  TraceCounts counts;
  double seconds = 0;
};

/// Traces one ray through the centre of each pixel.
ViewResult render_view(const Scene& scene, const Camera& camera, const ViewOptions& options);

/// A picture of a view's values to look at, in [0, 1]: depth from near (bright) to far, primitives in colours, normals
/// as colours, counts as a heat map from 0 to the largest.
Image displayed(View view, const Image& values);

}  // namespace kerf
