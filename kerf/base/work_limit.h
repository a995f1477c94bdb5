#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <string>

#include "kerf/base/error.h"

namespace kerf {

/// When long work is to be given up: too late, too large, or no longer wanted. By default: never.
struct WorkLimit {
  using Clock = std::chrono::steady_clock;

  Clock::time_point deadline = Clock::time_point::max();
  size_t bytes = static_cast<size_t>(-1);        ///< what the work may take, at most
  const std::atomic<bool>* cancelled = nullptr;  ///< becomes true when the work is not wanted any more

  /// From now on; infinite: never.
  static WorkLimit seconds(double seconds) {
    constexpr double kLongest = 1e8;  // some years: what does not fit a clock's number must not
    WorkLimit limit;
    if (seconds >= kLongest) return limit;
    limit.deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    return limit;
  }

  /// Throws Error(stopped) if the time is over or the work is cancelled. Some 30 ns: not for every triangle.
  void check() const {
    if (cancelled != nullptr && cancelled->load(std::memory_order_relaxed)) stop("it was cancelled");
    if (deadline != Clock::time_point::max() && Clock::now() > deadline) stop("the time allowed is over");
  }
  /// Throws Error(stopped) if the work needs more memory than it may have; else as check().
  void check(size_t needed) const {
    if (needed > bytes) {
      stop("it needs " + std::to_string(needed) + " bytes, and " + std::to_string(bytes) + " are allowed");
    }
    check();
  }

 private:
  [[noreturn]] static void stop(const std::string& why) { throw Error(ErrorCode::stopped, "build", why); }
};

}  // namespace kerf
