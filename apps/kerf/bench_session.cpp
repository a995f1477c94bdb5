#include "apps/kerf/bench_session.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>

#include "apps/kerf/bench_output.h"
#include "apps/kerf/command.h"
#include "apps/kerf/study_output.h"
#include "kerf/base/error.h"
#include "kerf/base/nearest_word.h"
#include "kerf/base/parallel.h"
#include "kerf/study/bench_tables.h"
#include "kerf/study/embree_builder.h"

namespace kerf::app {
namespace {

/// The sizes of a family's models: each ten times the one before.
std::vector<uint64_t> growth_sizes(double up_to) {
  std::vector<uint64_t> sizes;
  for (uint64_t size = kBenchGrowthFrom; static_cast<double>(size) <= up_to * 1.0001; size *= 10) sizes.push_back(size);
  return sizes;
}

}  // namespace

std::vector<int> parse_threads(const std::string& text) {
  const int most = thread_count();
  std::vector<int> counts;
  for (const std::string& word : words_of(text)) {
    int count = -1;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
    if (error != std::errc() || end != word.data() + word.size() || count < 0 || count > most) {
      throw Error(ErrorCode::invalid_option, "--threads",
                  fmt::format("'{}' is not a number of threads that this machine has: 0 (all) to {}", word, most));
    }
    if (count == 0) count = most;
    if (std::find(counts.begin(), counts.end(), count) == counts.end()) counts.push_back(count);
  }
  return counts;
}

bool is_against_embree(const std::string& text) {
  constexpr std::string_view kNames[] = {"embree", "none"};
  if (text.empty()) return has_embree();
  if (text == "none") return false;
  if (text != "embree") {
    throw Error(ErrorCode::invalid_option, "--against",
                fmt::format("unknown rival '{}'{}", text, suggestion(text, kNames)));
  }
  if (!has_embree()) throw Error(ErrorCode::invalid_option, "--against", "this build of Kerf has no Embree");
  return true;
}

BenchSession::BenchSession(const BenchArguments& a)
    : a_(a),
      bar_(a.quiet),
      turns_(parse_turns(a.turn.empty() ? "straight" : a.turn)),
      threads_(parse_threads(a.thread_counts.empty() ? "1" : a.thread_counts)) {
  const auto [width, height] = parse_size(a.size.empty() ? kBenchSize : a.size);
  static_cast<MeasureOptions&>(options_) = measure_options(a);
  options_.width = width;
  options_.height = height;
  options_.kinds = parse_kinds(a.rays.empty() ? kBenchRays : a.rays);
  options_.rows = a.rows.empty() ? bench_rows() : rows_of(a.rows);
  options_.repeat = a.repeat.value_or(kBenchRepeat);
  options_.with_embree = is_against_embree(a.against);
  options_.progress = [this](double done, std::string_view what) {
    return bar_((static_cast<double>(step_) + done) / static_cast<double>(steps_), what);
  };
}

void BenchSession::run() {
  const std::vector<uint64_t> sizes = a_.growth.empty() ? std::vector<uint64_t>() : growth_sizes(*a_.up_to);
  steps_ = (a_.inputs.size() + sizes.size()) * turns_.size() * threads_.size();
  for (const std::string& input : a_.inputs) {
    if (interrupted()) return;
    add(read_study_scene(a_, input, static_cast<double>(options_.width) / options_.height), "");
  }
  for (const uint64_t size : sizes) {
    if (interrupted()) return;
    add(made_scene(fmt::format("{} {}", a_.growth, size), a_.growth, size, 1), a_.growth);
  }
}

void BenchSession::add(const StudyScene& scene, const std::string& family) {
  for (const std::string& turn : turns_) {
    StudyScene turned = turned_scene(scene, turn);
    turned.name = scene.name;
    for (const int threads : threads_) {
      if (interrupted()) return;
      options_.threads = threads;
      BenchScene result = bench(turned, turn, options_);
      result.family = family;
      const bool has_any =
          std::any_of(result.rows.begin(), result.rows.end(), [](const auto& r) { return r.finished; });
      if (has_any || !interrupted()) scenes_.push_back(std::move(result));
      ++step_;
    }
  }
}

void BenchSession::write() {
  ignore_interrupts();
  if (!a_.json.empty()) write_json(a_.json, bench_json(scenes_));
  if (a_.json != "-") fmt::print("{}\n\n{}", machine_line(), bench_text(scenes_));
}

}  // namespace kerf::app
