#pragma once

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "kerf/base/error.h"
#include "kerf/base/work_meter.h"

namespace kerf {

/// What it takes to divide so many things down to single ones, about, in units of progress: parts never take more than
/// the whole.
inline double work_of_dividing(double count) { return count > 1 ? count * std::log2(count) : 0; }

/// When long work is to be given up: too late, too large, or no longer wanted. By default: never.
struct WorkLimit {
  using Clock = std::chrono::steady_clock;

  Clock::time_point deadline = Clock::time_point::max();
  size_t bytes = static_cast<size_t>(-1);        ///< what the work may take, at most
  const std::atomic<bool>* cancelled = nullptr;  ///< becomes true when the work is not wanted any more
  WorkMeter* meter = nullptr;                    ///< told how far the work is; Scene::build() sets its own

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
    if (meter != nullptr && !meter->tell()) stop("it was cancelled");
    if (deadline != Clock::time_point::max() && Clock::now() > deadline) stop("the time allowed is over");
  }
  /// Throws Error(stopped) if the work needs more memory than it may have; else as check().
  void check(size_t needed) const {
    if (needed > bytes) {
      stop("it needs " + std::to_string(needed) + " bytes, and " + std::to_string(bytes) + " are allowed");
    }
    check();
  }

  /// What is left of the stage, or of the ProgressPart, is so many units of work.
  void plan(double units) const {
    if (meter != nullptr) meter->plan(units);
  }
  /// So many of them are done; then as check().
  void advance(double units) const {
    if (meter != nullptr) meter->advance(units);
    check();
  }

 private:
  [[noreturn]] static void stop(const std::string& why) { throw Error(ErrorCode::stopped, "build", why); }
};

/// The limit of the work that this thread does now, or nullptr. parallel_for(), parallel_invoke() and with_threads()
/// hand it on to the threads that help, and look at it before each block: so parallel work needs no checks of its own.
const WorkLimit* current_limit();

/// check() of the current limit.
inline void check_current_limit() {
  if (const WorkLimit* limit = current_limit()) limit->check();
}

/// Looks at the current limit every few thousand steps, of long loops on one thread.
class LimitWatch {
 public:
  void step() {
    if (++steps_ % kEvery == 0) check_current_limit();
  }

 private:
  static constexpr uint32_t kEvery = 4096;

  uint32_t steps_ = 0;
};

/// Makes a limit the current one of this thread; none for nullptr.
class LimitScope {
 public:
  explicit LimitScope(const WorkLimit* limit);
  ~LimitScope();
  LimitScope(const LimitScope&) = delete;
  LimitScope& operator=(const LimitScope&) = delete;

 private:
  const WorkLimit* previous_;
};

/// While it lives, what is planned is `share` of what is left of the stage or of the part around it.
class ProgressPart {
 public:
  ProgressPart(const WorkLimit& limit, double share);
  ~ProgressPart();
  ProgressPart(const ProgressPart&) = delete;
  ProgressPart& operator=(const ProgressPart&) = delete;

 private:
  WorkMeter* meter_;
  double until_ = 0;  ///< of what is around it
};

/// Memory that the work of the current limit holds as long as this lives: large arrays, as they are made. Throws
/// Error(stopped) where more is held than the limit allows.
class HeldBytes {
 public:
  HeldBytes();
  explicit HeldBytes(size_t bytes) : HeldBytes() { set(bytes); }
  ~HeldBytes() { release(); }
  /// A copy holds as much again.
  HeldBytes(const HeldBytes& other) : limit_(other.limit_), meter_(other.meter_) { set(other.bytes_); }
  HeldBytes& operator=(const HeldBytes& other) { return *this = HeldBytes(other); }
  HeldBytes(HeldBytes&& other) noexcept;
  HeldBytes& operator=(HeldBytes&& other) noexcept;

  /// More or less than before.
  void set(size_t bytes);
  /// So much more, or less; from any thread.
  void add(size_t bytes);
  void subtract(size_t bytes);
  void release() { subtract(bytes_); }
  size_t bytes() const { return bytes_; }

 private:
  const WorkLimit* limit_;
  WorkMeter* meter_;
  std::atomic<size_t> bytes_ = 0;
};

}  // namespace kerf
