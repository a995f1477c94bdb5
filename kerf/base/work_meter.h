#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

namespace kerf {

/// How far long work has come and what memory it holds, counted by all of its threads. Whoever begins the work makes
/// one and hangs it into the WorkLimit that goes with the work.
class WorkMeter {
 public:
  /// Takes the share that is done, from 0 to 1, and what is being done; returns false if no more is wanted.
  using Progress = std::function<bool(double, std::string_view)>;

  /// Without progress(), memory alone is counted.
  explicit WorkMeter(Progress progress = nullptr) : progress_(std::move(progress)) {}
  WorkMeter(const WorkMeter&) = delete;
  WorkMeter& operator=(const WorkMeter&) = delete;

  /// What follows, until share `until` of all work. Its words must outlive the work.
  void begin_stage(std::string_view what, double until);
  /// All is done.
  void end();
  /// The rest of the stage, or of its part, is so many units of work, whatever a unit is.
  void plan(double units);
  /// So many of them are done. From any thread.
  void advance(double units) { done_.fetch_add(units, std::memory_order_relaxed); }

  /// Calls progress(), from one thread at a time and not more often than every kInterval unless `at_once`. False from
  /// the first time on that it returned false or threw; what it throws comes out of here.
  bool tell(bool at_once = false);
  /// Throws what progress() threw, if it did: other threads may have ended with an Error (stopped) before it arrived.
  void rethrow() const {
    if (failure_ != nullptr) std::rethrow_exception(failure_);
  }

  /// Memory that is held from now on, or was until now. `hold` returns what is held then.
  size_t hold(size_t bytes);
  void release(size_t bytes) { held_ -= bytes; }
  /// The most that was held at once.
  size_t peak() const { return peak_; }

  static constexpr std::chrono::milliseconds kInterval{50};

 private:
  friend class ProgressPart;
  using Clock = std::chrono::steady_clock;

  double share() const;

  const Progress progress_;
  std::atomic<bool> is_unwanted_ = false, is_telling_ = false;
  std::atomic<Clock::rep> next_ = 0;  // when to tell again
  std::exception_ptr failure_;

  mutable std::mutex mutex_;  // of what follows but for atomics
  std::string_view what_;
  double from_ = 0, until_ = 0;  // shares between which the units planned lie
  double units_ = 0;
  double told_ = 0;
  std::atomic<double> done_ = 0;  // of the units

  std::atomic<size_t> held_ = 0, peak_ = 0;
};

}  // namespace kerf
