#include "kerf/render/views.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <vector>

#include "kerf/base/parallel.h"

namespace kerf {
namespace {

constexpr ViewEntry kViews[] = {
    {View::depth, "depth", "distance along the ray; infinite where nothing is hit", 1},
    {View::primitive, "primitive", "the number of the primitive hit, exact up to 16777216; -1 for none", 1},
    {View::normal, "normal", "the unit normal of the primitive hit", 3},
    {View::uv, "uv", "the coordinates on the primitive hit", 3},
    {View::nodes, "nodes", "nodes that the ray visited", 1},
    {View::triangles, "triangles", "primitives that the ray was tested against", 1},
};

const ViewEntry& entry_of(View view) { return kViews[static_cast<size_t>(view)]; }

/// The values of one pixel, up to three.
void write_values(const Scene& scene, View view, const Hit& hit, const TraceCounts& counts, float* out) {
  switch (view) {
    case View::depth:
      out[0] = hit.t;
      break;
    case View::primitive:
      out[0] = hit ? static_cast<float>(hit.primitive) : -1.0F;
      break;
    case View::normal: {
      const Vec3f normal = scene.normal(hit);
      for (uint32_t i = 0; i < 3; ++i) out[i] = normal[i];
      break;
    }
    case View::uv:
      out[0] = hit.u;
      out[1] = hit.v;
      out[2] = 0;
      break;
    case View::nodes:
      out[0] = static_cast<float>(counts.nodes);
      break;
    case View::triangles:
      out[0] = static_cast<float>(counts.primitives);
      break;
  }
}

/// A number's colour: bright, and unlike that of its neighbours.
Vec3f distinct_color(uint32_t number) {
  uint32_t x = number * 0x9E3779B1U;
  x ^= x >> 15;
  x *= 0x85EBCA77U;
  x ^= x >> 13;
  const auto part = [&](int shift) { return 0.25F + 0.75F * static_cast<float>((x >> shift) & 0xFF) / 255; };
  return {part(0), part(8), part(16)};
}

/// From dark blue over green and yellow to red, for x in [0, 1].
Vec3f heat(float x) {
  constexpr Vec3f kStops[] = {
      {0.05F, 0.05F, 0.3F}, {0.1F, 0.4F, 0.8F}, {0.2F, 0.75F, 0.4F}, {0.95F, 0.85F, 0.2F}, {0.85F, 0.1F, 0.1F}};
  const float at = std::clamp(x, 0.0F, 1.0F) * 4;
  const auto stop = std::min(static_cast<uint32_t>(at), 3U);
  return kStops[stop] + (kStops[stop + 1] - kStops[stop]) * (at - static_cast<float>(stop));
}

/// The smallest and largest finite value; 0 and 1 if there is none.
std::pair<float, float> finite_range(const Image& values) {
  float least = Box3f::kInfinity, most = -Box3f::kInfinity;
  for (const float x : values.pixels) {
    if (!std::isfinite(x)) continue;
    least = std::min(least, x);
    most = std::max(most, x);
  }
  return least <= most ? std::pair(least, most) : std::pair(0.0F, 1.0F);
}

Vec3f displayed_pixel(View view, const float* value, float least, float most) {
  switch (view) {
    case View::depth: {
      if (!std::isfinite(value[0])) return {};
      const float gray = most > least ? 1 - 0.9F * (value[0] - least) / (most - least) : 1;
      return {gray, gray, gray};
    }
    case View::primitive:
      return value[0] < 0 ? Vec3f{} : distinct_color(static_cast<uint32_t>(value[0]));
    case View::normal: {
      const Vec3f normal{value[0], value[1], value[2]};
      return normal == Vec3f{} ? Vec3f{} : normal * 0.5F + Vec3f{0.5F, 0.5F, 0.5F};
    }
    case View::uv:
      return {value[0], value[1], value[2]};
    case View::nodes:
    case View::triangles:
      return heat(most > 0 ? value[0] / most : 0);
  }
  return {};
}

}  // namespace

std::span<const ViewEntry> views() { return kViews; }

ViewResult render_view(const Scene& scene, const Camera& camera, const ViewOptions& options) {
  const CameraRays rays(camera, options.width, options.height);
  const uint32_t channels = entry_of(options.view).channels;
  ViewResult result;
  result.values = {options.width, options.height, channels, {}};
  result.values.pixels.resize(size_t{options.width} * options.height * channels);
  const auto start = std::chrono::steady_clock::now();
  std::mutex mutex;  // of the sums in `result`, `rows_done` and progress()
  std::atomic<bool> stop = false;
  uint32_t rows_done = 0;
  const auto render_rows = [&](size_t begin, size_t end) {
    TraceCounts counts;
    uint64_t hits = 0, traced = 0;
    for (size_t y = begin; y < end; ++y) {
      const bool reached = !stop.load(std::memory_order_relaxed);
      for (uint32_t x = 0; x < options.width; ++x) {
        TraceCounts own;
        const Hit hit = reached ? scene.closest_hit(rays.center(x, static_cast<uint32_t>(y)), own) : Hit{};
        write_values(scene, options.view, hit, own, &result.values.pixels[(y * options.width + x) * channels]);
        counts.nodes += own.nodes;
        counts.primitives += own.primitives;
        counts.boxes += own.boxes;
        hits += hit ? 1 : 0;
        traced += reached ? 1 : 0;
      }
    }
    const std::lock_guard lock(mutex);
    result.counts.nodes += counts.nodes;
    result.counts.primitives += counts.primitives;
    result.counts.boxes += counts.boxes;
    result.hits += hits;
    result.rays += traced;
    rows_done += static_cast<uint32_t>(end - begin);
    if (options.progress && !stop && !options.progress(static_cast<double>(rows_done) / options.height)) stop = true;
  };
  with_threads(options.threads, [&] { parallel_for(options.height, 4, render_rows); });
  result.complete = result.rays == uint64_t{options.width} * options.height;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

Image displayed(View view, const Image& values) {
  const auto [least, most] = finite_range(values);
  Image picture{values.width, values.height, 3, {}};
  const size_t pixels = size_t{values.width} * values.height;
  picture.pixels.resize(pixels * 3);
  for (size_t i = 0; i < pixels; ++i) {
    const Vec3f color = displayed_pixel(view, &values.pixels[i * values.channels], least, most);
    for (uint32_t c = 0; c < 3; ++c) picture.pixels[i * 3 + c] = color[c];
  }
  return picture;
}

}  // namespace kerf
