#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/kerf/progress_bar.h"
#include "apps/kerf/study_session.h"
#include "kerf/study/bench.h"

namespace kerf::app {

inline constexpr const char* kBenchRays = "primary,diffuse,shadow";
inline constexpr const char* kBenchSize = "480x320";
inline constexpr int kBenchRepeat = 7;
inline constexpr uint64_t kBenchGrowthFrom = 10000;

/// What kerf bench is told.
struct BenchArguments : StudyArguments {
  std::string against, thread_counts;  // empty: not given
};

/// Numbers of threads, each once. Throws Error (invalid_option).
std::vector<int> parse_threads(const std::string& text);

/// "embree" or "none", nothing for what this build has. Throws Error (invalid_option) with the nearest right word.
bool is_against_embree(const std::string& text);

/// One or more scenes, straight and turned, with one or more numbers of threads.
class BenchSession {
 public:
  explicit BenchSession(const BenchArguments& arguments);

  /// Measures all that was asked for, until an interrupt.
  void run();
  /// Writes and prints what there is.
  void write();
  bool has_results() const { return !scenes_.empty(); }

 private:
  void add(const StudyScene& scene, const std::string& family);

  const BenchArguments& a_;
  ProgressBar bar_;
  BenchOptions options_;
  std::vector<std::string> turns_;
  std::vector<int> threads_;
  std::vector<BenchScene> scenes_;
  size_t step_ = 0, steps_ = 1;
};

}  // namespace kerf::app
