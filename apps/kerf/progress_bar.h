#pragma once

#include <fmt/core.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <string_view>

#include "apps/kerf/command.h"

namespace kerf::app {

/// A bar with the time left on a terminal, nothing elsewhere; also where an interrupt is noticed.
class ProgressBar {
 public:
  explicit ProgressBar(bool quiet) : shown_(!quiet && isatty(STDERR_FILENO) != 0) {}
  ~ProgressBar() {
    if (drawn_) fmt::print(stderr, "\r{:120}\r", "");
  }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  bool operator()(double done) { return (*this)(done, ""); }

  /// Also says what is being done.
  bool operator()(double done, std::string_view what) {
    const auto now = std::chrono::steady_clock::now();
    if (shown_ && now - last_ > std::chrono::milliseconds(100)) {
      const double spent = std::chrono::duration<double>(now - start_).count();
      const int full = static_cast<int>(done * 30);
      fmt::print(stderr, "\r[{:=<{}}{:{}}] {:3.0f} %, {:.1f} s left {:<{}.{}} ", "", full, "", 30 - full, done * 100,
                 done > 0 ? spent / done - spent : 0, what, kWords, kWords);
      std::fflush(stderr);
      last_ = now;
      drawn_ = true;
    }
    return !interrupted();
  }

 private:
  static constexpr int kWords = 60;

  bool shown_, drawn_ = false;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), last_ = start_;
};

}  // namespace kerf::app
