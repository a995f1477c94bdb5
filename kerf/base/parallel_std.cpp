// The task back end without oneTBB: a thread is started where one of the budget is free, else the caller does the work.
// Starting threads costs more than oneTBB's tasks do; the thread sanitizer understands it.

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <vector>

#include "kerf/base/fp_environment.h"
#include "kerf/base/parallel.h"
#include "kerf/base/work_limit.h"

namespace kerf {
namespace {

/// Threads that a with_threads() scope may have at once, its caller's own included.
struct Budget {
  explicit Budget(int threads) : limit(threads), free(threads - 1) {}

  bool take() {
    int seen = free.load();
    while (seen > 0) {
      if (free.compare_exchange_weak(seen, seen - 1)) return true;
    }
    return false;
  }
  void give_back() { ++free; }

  const int limit;
  std::atomic<int> free;
};

Budget& machine_budget() {
  static Budget budget(static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
  return budget;
}

thread_local Budget* current_budget = nullptr;

Budget& budget() { return current_budget != nullptr ? *current_budget : machine_budget(); }

/// Keeps the first exception of several threads.
class FirstException {
 public:
  template <class F>
  void guard(F&& f) {
    try {
      f();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (first_ == nullptr) first_ = std::current_exception();
    }
  }
  void rethrow() const {
    if (first_ != nullptr) std::rethrow_exception(first_);
  }

 private:
  std::mutex mutex_;
  std::exception_ptr first_;
};

/// Starts f on a thread if one of the budget is free and the system gives one; it returns its place at its end.
template <class F>
std::optional<std::thread> try_start(Budget& from, FirstException& failure, F f) {
  if (!from.take()) return std::nullopt;
  const WorkLimit* const limit = current_limit();
  try {
    return std::thread([&from, &failure, f, limit] {
      const StandardFloat standard;
      const LimitScope scope(limit);
      current_budget = &from;
      failure.guard(f);
      from.give_back();
    });
  } catch (const std::system_error&) {  // no more threads or memory: the caller does the work
    from.give_back();
    return std::nullopt;
  }
}

}  // namespace

const char* task_backend() { return "std"; }

int thread_count() { return budget().limit; }

namespace detail {

void run_parallel_for(size_t count, size_t grain, void (*body)(void*, size_t, size_t), void* data) {
  grain = std::max<size_t>(grain, 1);
  const size_t blocks = (count + grain - 1) / grain;
  std::atomic<size_t> next = 0;
  const auto work = [&] {
    const StandardFloat standard;
    for (size_t block = next++; block < blocks; block = next++) {
      if (blocks > 1) check_current_limit();
      body(data, block * grain, std::min(count, (block + 1) * grain));
    }
  };
  FirstException failure;
  std::vector<std::thread> threads;
  threads.reserve(std::min<size_t>(blocks, static_cast<size_t>(thread_count())));  // so that push_back cannot throw
  while (threads.size() + 1 < blocks && threads.size() < threads.capacity()) {
    std::optional<std::thread> thread = try_start(budget(), failure, work);
    if (!thread) break;
    threads.push_back(std::move(*thread));
  }
  failure.guard(work);
  for (std::thread& thread : threads) thread.join();
  failure.rethrow();
}

void run_parallel_invoke(void (*body)(void*, int), void* data) {
  const StandardFloat standard;
  FirstException failure;
  const auto part = [=](int which) {
    check_current_limit();
    body(data, which);
  };
  std::optional<std::thread> other = try_start(budget(), failure, [=] { part(1); });
  failure.guard([&] { part(0); });
  if (other) {
    other->join();
  } else {
    failure.guard([&] { part(1); });
  }
  failure.rethrow();
}

void run_with_threads(int threads, void (*body)(void*), void* data) {
  if (threads <= 0) return body(data);
  Budget scope(threads);
  struct Restore {
    Budget* previous = current_budget;
    ~Restore() { current_budget = previous; }
  } restore;
  current_budget = &scope;
  body(data);
}

}  // namespace detail
}  // namespace kerf
