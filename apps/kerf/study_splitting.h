#pragma once

#include <string>
#include <vector>

#include "apps/kerf/progress_bar.h"
#include "apps/kerf/study_session.h"
#include "kerf/study/splitting_study.h"

namespace kerf::app {

inline constexpr const char* kSplittingSize = "150x100";
inline constexpr const char* kSplittingRays = "primary,shadow,diffuse";
inline constexpr const char* kSplittingTurns = "straight,x,y,z,xyz";
inline constexpr int kSplittingRepeat = 15;

/// Finds mistakes in the words of kerf study --splitting. Throws Error (invalid_option).
void check_splitting(const StudyArguments& arguments);

/// What splitting does to one or more scenes, straight and turned.
class SplittingSession {
 public:
  explicit SplittingSession(const StudyArguments& arguments);

  /// Measures all that was asked for, until an interrupt.
  void run();
  /// Writes and prints what there is.
  void write(const std::string& command_line);
  bool has_results() const { return !scenes_.empty(); }

 private:
  const StudyArguments& a_;
  ProgressBar bar_;
  SplittingOptions options_;
  std::vector<std::string> turns_;
  std::vector<SplittingScene> scenes_;
  size_t step_ = 0;
};

}  // namespace kerf::app
