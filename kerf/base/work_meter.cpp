#include "kerf/base/work_meter.h"

#include <algorithm>

#include "kerf/base/work_limit.h"

namespace kerf {

/// Within the stage or part; the lock is held.
double WorkMeter::share() const {
  const double done = units_ > 0 ? std::clamp(done_.load(std::memory_order_relaxed) / units_, 0.0, 1.0) : 0;
  return from_ + (until_ - from_) * done;
}

void WorkMeter::begin_stage(std::string_view what, double until) {
  const std::lock_guard lock(mutex_);
  what_ = what;
  from_ = std::max(from_, until_);
  until_ = std::max(from_, until);
  units_ = 0;
  done_ = 0;
}

void WorkMeter::end() {
  begin_stage("done", 1);
  begin_stage("done", 1);
}

void WorkMeter::plan(double units) {
  const std::lock_guard lock(mutex_);
  from_ = share();
  units_ = units;
  done_ = 0;
}

bool WorkMeter::tell(bool at_once) {
  if (is_unwanted_.load(std::memory_order_relaxed)) return false;
  if (!progress_) return true;
  const Clock::rep now = Clock::now().time_since_epoch().count();
  if (!at_once && now < next_.load(std::memory_order_relaxed)) return true;
  if (is_telling_.exchange(true, std::memory_order_acquire)) return true;
  next_ = now + std::chrono::duration_cast<Clock::duration>(kInterval).count();
  double done = 0;
  std::string_view what;
  {
    const std::lock_guard lock(mutex_);
    done = told_ = std::max(told_, share());
    what = what_.empty() ? "begin" : what_;  // before the first stage
  }
  bool is_wanted = false;
  try {
    const LimitScope none(nullptr);  // what progress() does is not this work
    is_wanted = progress_(done, what);
  } catch (...) {
    failure_ = std::current_exception();
    is_unwanted_ = true;
    throw;
  }
  if (!is_wanted) is_unwanted_ = true;
  is_telling_.store(false, std::memory_order_release);
  return is_wanted;
}

size_t WorkMeter::hold(size_t bytes) {
  const size_t held = held_ += bytes;
  size_t peak = peak_.load(std::memory_order_relaxed);
  while (held > peak && !peak_.compare_exchange_weak(peak, held)) {
  }
  return held;
}

}  // namespace kerf
