#include "kerf/study/figures/figure_work.h"

#include <atomic>
#include <mutex>

#include "kerf/base/error.h"
#include "kerf/base/parallel.h"

namespace kerf {

void stop_figure() { throw Error(ErrorCode::stopped, "figure", "it was cancelled"); }

void for_each_row(uint32_t height, int threads, const FigureProgress& progress,
                  const std::function<void(uint32_t)>& f) {
  std::mutex mutex;  // of `done` and progress()
  std::atomic<bool> stop = false;
  size_t done = 0;
  const auto work = [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end && !stop.load(std::memory_order_relaxed); ++y) f(static_cast<uint32_t>(y));
    const std::lock_guard lock(mutex);
    done += end - begin;
    if (progress && !stop && !progress(static_cast<double>(done) / height)) stop = true;
  };
  with_threads(threads, [&] { parallel_for(height, 4, work); });
  if (stop) stop_figure();
}

FigureProgress part_of(const FigureProgress& progress, size_t index, size_t count) {
  if (!progress) return {};
  return [progress, index, count](double done) {
    return progress((static_cast<double>(index) + done) / static_cast<double>(count));
  };
}

}  // namespace kerf
