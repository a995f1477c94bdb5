#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kerf/study/hit_verdict.h"

namespace kerf {

enum class BenchEngine { kerf, embree };

std::string_view engine_name(BenchEngine engine);  ///< "kerf", "embree"

/// How rays are handed over.
enum class Feed { loop, batch, sorted, packets_8, packets_16, stream };

struct FeedEntry {
  Feed feed;
  std::string_view name;  ///< in JSON and tables
  std::string_view mode;  ///< "single": one call for each ray in the caller's order; "batch": anything else
  std::string_view sentence;
};

/// All of them, in the order of the enum.
std::span<const FeedEntry> feeds();
const FeedEntry& feed_entry(Feed feed);

/// One row's rays of one kind, fed one way.
struct BenchRun {
  size_t kind = 0;  ///< its number in BenchScene::kinds
  Feed feed = Feed::loop;
  size_t hits = 0;
  std::optional<size_t> unlike_robust;  ///< rays for which Embree's robust scene has another answer; see bench()
  std::optional<size_t> unlike_kerf;    ///< of Kerf's rows: rays whose hit is not that of the first one, bit for bit
  std::vector<double> seconds;          ///< runs of one number pair
};

/// One structure of one engine.
struct BenchRow {
  BenchEngine engine = BenchEngine::kerf;
  std::string quality;  ///< a preset, or a pipeline without its layout; of Embree: "low", "medium", "high", "robust"
  std::string layout;   ///< of Embree: what it says that it built
  std::string isa;      ///< the instruction set of the kernels, "scalar" for none; empty until it is built
  std::string builder;  ///< the pipeline in its canonical spelling; of Embree: what it calls its builder
  bool finished = false;
  std::string why_not = "it was interrupted";

  std::optional<double> references;  ///< in leaves; of Embree: by its own statistics, within some tenths of a percent
  std::vector<std::string> short_of_room;  ///< of Kerf's rows: stages that the limit of bytes kept from cuts
  size_t bytes = 0;                        ///< without the caller's vertices
  std::vector<double> builds;              ///< seconds
  std::vector<BenchRun> runs;

  /// The same in every scene.
  std::string name() const { return std::string(engine_name(engine)) + " " + quality + " " + layout_name(); }
  /// The layout of a row of Kerf's; nothing for Embree's, which chooses by itself.
  std::string layout_name() const { return engine == BenchEngine::kerf ? layout : ""; }
  const BenchRun* run(size_t kind, Feed feed) const;
};

/// What Kerf finds beside Embree's robust scene with one kind of rays, all traced to their closest hit.
struct BenchVerdicts {
  std::array<size_t, kVerdicts> counts{};  ///< by Verdict
  size_t not_judged = 0;                   ///< answers that differ about something that is no triangle
};

/// A scene as it stands, or turned, with one number of threads.
struct BenchScene {
  std::string name, turn;  ///< turn: "straight" or another of turn_names()
  std::string family;      ///< of a model made in several sizes: its name
  int threads = 1;
  size_t triangles = 0;
  std::vector<std::string> kinds;  ///< of rays
  std::vector<size_t> ray_counts;  ///< of each kind
  std::string rival;               ///< what Embree runs with, in lines; empty without it
  std::vector<BenchRow> rows;
  std::vector<BenchVerdicts> verdicts;  ///< of each kind of rays, of Kerf's first row; none without Embree

  std::string title() const { return turn == "straight" ? name : name + " turned " + turn; }
  /// Embree's row of that quality; nothing where it did not finish.
  const BenchRow* embree(std::string_view quality) const;
  /// The row of that name(); nothing where it did not finish.
  const BenchRow* row(std::string_view wanted) const;
  /// Million rays per second, the median; NaN where unknown.
  double mrays(const BenchRun& run) const;
};

/// How many times as fast as `base` a run is: the median over the runs that pair; NaN where one is not known.
double speed_ratio(const BenchRun* base, const BenchRun* run);

/// Median seconds of a row's builds; NaN where unknown.
double build_seconds(const BenchRow* row);

}  // namespace kerf
