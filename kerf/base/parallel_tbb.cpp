#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>

#include "kerf/base/error.h"
#include "kerf/base/fp_environment.h"
#include "kerf/base/parallel.h"
#include "kerf/base/work_limit.h"

namespace kerf {

namespace {

constexpr int kMostThreads = 4096;

/// More threads than the machine has are asked for on purpose (to test), and oneTBB would print a warning. Kept for
/// good: arenas of the usual size are not affected, and a smaller limit of the program's own still holds.
void allow_more_threads() {
  static const tbb::global_control more(tbb::global_control::max_allowed_parallelism, kMostThreads);
}

/// Where work around this work was cancelled, because another part of it threw or by the host program's own tasks,
/// oneTBB leaves out what has not begun and returns as if all were done. The error of a part that threw first is the
/// one that is passed on, not this one.
void check_all_ran(tbb::task_group_context& context) {
  if (context.is_group_execution_cancelled()) throw Error(ErrorCode::stopped, "tasks", "they were cancelled");
}

}  // namespace

const char* task_backend() { return "tbb"; }

int thread_count() { return tbb::this_task_arena::max_concurrency(); }

namespace detail {

void run_parallel_for(size_t count, size_t grain, void (*body)(void*, size_t, size_t), void* data) {
  grain = std::max<size_t>(grain, 1);
  const size_t blocks = (count + grain - 1) / grain;
  const WorkLimit* const limit = current_limit();
  tbb::task_group_context context;
  tbb::parallel_for(
      size_t{0}, blocks,
      [&](size_t block) {
        const StandardFloat standard;
        const LimitScope scope(limit);
        if (blocks > 1) check_current_limit();
        body(data, block * grain, std::min(count, (block + 1) * grain));
      },
      context);
  check_all_ran(context);
}

void run_parallel_invoke(void (*body)(void*, int), void* data) {
  const WorkLimit* const limit = current_limit();
  const auto part = [=](int which) {
    const StandardFloat standard;
    const LimitScope scope(limit);
    check_current_limit();
    body(data, which);
  };
  tbb::task_group_context context;
  tbb::parallel_invoke([&] { part(0); }, [&] { part(1); }, context);
  check_all_ran(context);
}

void run_with_threads(int threads, void (*body)(void*), void* data) {
  if (threads <= 0) return body(data);
  threads = std::min(threads, kMostThreads);
  if (threads > tbb::info::default_concurrency()) allow_more_threads();
  const WorkLimit* const limit = current_limit();
  tbb::task_arena(threads).execute([&] {
    const LimitScope scope(limit);
    body(data);
  });
}

}  // namespace detail
}  // namespace kerf
