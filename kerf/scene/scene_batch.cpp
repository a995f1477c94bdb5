#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"
#include "kerf/scene/scene.h"

namespace kerf {
namespace {

[[noreturn]] void refuse_lengths(const std::string& sentence) {
  throw Error(ErrorCode::invalid_argument, "batch", sentence);
}

void check_lengths(size_t rays, size_t results) {
  if (rays == results) return;
  refuse_lengths(std::to_string(rays) + " rays, but room for " + std::to_string(results) + " results");
}

void check_lengths(const RayColumns& rays) {
  if (const std::optional<std::string> odd = find_odd_length(rays)) refuse_lengths(*odd);
}

constexpr size_t kMostAtOnce = 4096;  // rays that a thread takes

/// Many, because batches gain from that, but some stretches for each thread.
size_t stretch_of(size_t rays) {
  constexpr size_t kLeast = 512, kForEach = 4;
  return std::clamp(rays / (kForEach * static_cast<size_t>(thread_count())), kLeast, kMostAtOnce);
}

/// query(begin, end) on stretches of the rays.
template <class F>
void run_batch(size_t rays, int threads, F&& query) {
  if (threads == 1) return query(0, rays);
  with_threads(threads, [&] { parallel_for(rays, stretch_of(rays), query); });
}

/// query(rays, begin) on stretches that were gathered from columns.
template <class F>
void run_columns(const RayColumns& columns, int threads, F&& query) {
  run_batch(columns.size(), threads, [&](size_t begin, size_t end) {
    std::vector<Ray> rays;
    rays.reserve(std::min(end - begin, kMostAtOnce));
    for (size_t first = begin; first < end; first += kMostAtOnce) {
      rays.clear();
      for (size_t i = first; i < std::min(first + kMostAtOnce, end); ++i) rays.push_back(columns[i]);
      query(std::span<const Ray>(rays), first);
    }
  });
}

}  // namespace

void Scene::closest_hit(std::span<const Ray> rays, std::span<Hit> hits, int threads) const {
  check_lengths(rays.size(), hits.size());
  run_batch(rays.size(), threads, [&](size_t begin, size_t end) {
    table_->closest_batch(data_, rays.subspan(begin, end - begin), hits.subspan(begin, end - begin));
  });
}

void Scene::any_hit(std::span<const Ray> rays, std::span<uint8_t> hits, int threads) const {
  check_lengths(rays.size(), hits.size());
  run_batch(rays.size(), threads, [&](size_t begin, size_t end) {
    table_->any_batch(data_, rays.subspan(begin, end - begin), hits.subspan(begin, end - begin));
  });
}

void Scene::closest_hit(const RayColumns& rays, const HitColumns& hits, int threads) const {
  check_lengths(rays);
  if (const std::optional<std::string> odd = find_odd_length(hits, rays.size())) refuse_lengths(*odd);
  run_columns(rays, threads, [&](std::span<const Ray> some, size_t first) {
    std::vector<Hit> found(some.size());
    table_->closest_batch(data_, some, found);
    for (size_t i = 0; i < found.size(); ++i) hits.set(first + i, found[i]);
  });
}

void Scene::any_hit(const RayColumns& rays, std::span<uint8_t> hits, int threads) const {
  check_lengths(rays);
  check_lengths(rays.size(), hits.size());
  run_columns(rays, threads, [&](std::span<const Ray> some, size_t first) {
    table_->any_batch(data_, some, hits.subspan(first, some.size()));
  });
}

void Scene::closest_hit(std::span<const Ray> rays, std::span<Hit> hits, TraceCounts& counts) const {
  check_lengths(rays.size(), hits.size());
  table_->closest_batch_counted(data_, rays, hits, counts);
}

void Scene::any_hit(std::span<const Ray> rays, std::span<uint8_t> hits, TraceCounts& counts) const {
  check_lengths(rays.size(), hits.size());
  table_->any_batch_counted(data_, rays, hits, counts);
}

}  // namespace kerf
