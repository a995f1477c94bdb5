#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "apps/kerf/progress_bar.h"
#include "apps/kerf/scene_input.h"
#include "kerf/study/html_report.h"
#include "kerf/study/paper.h"
#include "kerf/study/row_measure.h"

namespace kerf::app {

/// What kerf study is told.
struct StudyArguments : SceneArguments {
  std::vector<std::string> inputs;
  std::string rows, rays, size, turn, sweep, growth;  // empty: not given
  std::string save_rays, load_rays, csv, html;
  bool is_paper = false, is_splitting = false, no_overlap = false, no_determinism = false;
  std::optional<int> repeat;
  std::optional<int> seeds;
  std::optional<double> up_to;
  double limit_seconds = std::numeric_limits<double>::infinity(), limit_gigabytes = 8;
};

inline constexpr const char* kStudyRows =
    "binned_sah,early_split(auto)+binned_sah,early_split(budget=3)+binned_sah,kd_sah";
inline constexpr const char* kStudySize = "1000x1000";
inline constexpr double kStudyUpTo = 1e6;
inline constexpr int kStudyRepeat = 5;

/// A list's words, between commas.
std::vector<std::string> words_of(const std::string& text);

/// Pipelines by name, none for an empty text; "all" stands for everything in the menu.
std::vector<std::string> rows_of(const std::string& text);

/// Throws Error (invalid_option) with the nearest right word.
std::vector<RayKind> parse_kinds(const std::string& text);

/// Names of turns, each once. Throws Error (invalid_option) with the nearest right word.
std::vector<std::string> parse_turns(const std::string& text);

/// How much a row may take, as told.
MeasureOptions measure_options(const StudyArguments& arguments);

/// Reads a scene, named after its file.
StudyScene read_study_scene(const StudyArguments& arguments, const std::string& input, double aspect);

/// The scene turned, with the turn in its name; as it is for none or "straight".
StudyScene turned_scene(StudyScene scene, const std::string& turn);

/// A study of one or more scenes on the command line.
class StudySession {
 public:
  explicit StudySession(const StudyArguments& arguments);

  /// Studies all that was asked for, until an interrupt.
  void run();
  /// Writes and prints what there is.
  void write(const std::string& command_line);
  bool has_results() const { return !results_.empty(); }

 private:
  void study_paper();
  void study_inputs();
  void study_growth();
  void add(const StudyScene& scene, const std::vector<PaperStudyRow>& rows);
  void load_or_save(const StudyScene& scene);
  bool is_taken() const;

  const StudyArguments& a_;
  ProgressBar bar_;
  StudyOptions options_;
  std::vector<StudyRays> rays_;
  std::vector<StudyResult> results_;
  std::vector<ReportPicture> pictures_;
  std::vector<std::string> notes_;
  size_t scene_ = 0, scenes_ = 1;
};

/// A check for CLI11: above 0; infinity is allowed, which its own check refuses.
std::string positive(const std::string& text);

}  // namespace kerf::app
