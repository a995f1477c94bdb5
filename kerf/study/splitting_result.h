#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kerf/scene/scene.h"

namespace kerf {

/// What a row of a splitting study stands for.
enum class SplittingRole { plain, automatic, fast, balanced, best, spatial_split, embree_high, reinsertion, budget };

struct SplittingRowEntry {
  SplittingRole role;
  std::string_view name;  ///< short, for people
  std::string_view pipeline;
  bool is_timed;       ///< its rays are timed, its builds too
  bool is_repeatable;  ///< whether its tree is compared for several numbers of threads
};

/// All rows but those of the sweep, plain first.
std::span<const SplittingRowEntry> splitting_study_rows();
const SplittingRowEntry& splitting_row(SplittingRole role);

/// References per primitive of the sweep's rows, ascending, and the pipeline of each.
std::span<const double> splitting_budgets();
std::string budget_pipeline(double budget);

/// What one row showed on one scene. Counts repeat exactly; times are of this machine.
struct SplittingRow {
  SplittingRole role = SplittingRole::plain;
  std::string pipeline;
  double budget = 0;  ///< of a row of the sweep
  bool finished = false;
  std::string why_not = "it was interrupted";

  double references_per_primitive = 0, sah_cost = 0;
  size_t bytes = 0;                  ///< of the finished structure
  std::optional<size_t> peak_bytes;  ///< the most that building held, as the build counts; none: not built
  uint64_t tree_hash = 0;
  std::vector<BuildReport::Seconds> builds;  ///< timed rows take turns, so builds of two rows with one number pair
  std::optional<SplitChoice> choice;
  std::vector<std::string> short_of_room;  ///< stages that the limit of bytes kept from cuts

  /// Of each kind of rays, in the order of SplittingScene::kinds.
  struct Rays {
    double nodes = 0, triangles = 0;  ///< per ray
    size_t hits = 0;
    std::vector<double> seconds;  ///< for all rays; runs of two rows with one number pair

    /// Nodes and triangles weigh the same, as in the surface area heuristic.
    double visits() const { return nodes + triangles; }
  };
  std::vector<Rays> rays;
};

/// R of early_split(auto) on the same scene in other units or with other axes.
struct SplittingVariant {
  std::string what;  ///< "1e-3 times the size"
  double references_per_primitive = 0;
};

/// A row's tree built with several numbers of threads.
struct SplittingTrees {
  SplittingRole role = SplittingRole::automatic;
  std::vector<int> threads;
  std::vector<uint64_t> hashes;
};

/// What came of a byte limit that cannot be kept.
struct SplittingRefusal {
  size_t allowed = 0;
  bool is_refused = false;
  double seconds = 0;    ///< until it was
  std::string sentence;  ///< of the refusal
};

/// A scene as it stands, or turned.
struct SplittingScene {
  std::string name, turn;  ///< turn: "straight" or another of turn_names()
  size_t triangles = 0;
  std::vector<std::string> kinds;  ///< of rays
  std::vector<size_t> ray_counts;  ///< of each kind
  std::vector<SplittingRow> rows;  ///< those of splitting_study_rows(), then the sweep
  std::vector<SplittingVariant> variants;
  std::optional<double> capped_references;  ///< R of early_split(auto,cap=kSplittingCap)
  std::vector<SplittingTrees> trees;
  std::optional<SplittingRefusal> refusal;
  std::vector<std::string> skipped;  ///< checks that were left out, each with why

  std::string title() const { return turn == "straight" ? name : name + " turned " + turn; }
  /// Nothing where it did not finish.
  const SplittingRow* row(SplittingRole role) const;
};

inline constexpr double kSplittingCap = 1.2;

/// Visits per ray of a row over those of the plain one, of one kind of rays; NaN where one is not known.
double visits_share(const SplittingScene& scene, const SplittingRow& row, size_t kind);
/// The geometric mean of that over all kinds that have rays.
double visits_share(const SplittingScene& scene, const SplittingRow& row);

/// Ray time of `base` over that of `row`, run by run: above 1, the row is faster.
std::vector<double> paired_speeds(const SplittingRow& base, const SplittingRow& row, size_t kind);
/// The geometric mean of that over all kinds that have rays, run by run.
std::vector<double> paired_speeds(const SplittingScene& scene, const SplittingRow& base, const SplittingRow& row);

/// Seconds to cut and to choose over those of the plain row's whole build: the median of paired builds; NaN if unknown.
double splitting_cost(const SplittingRow& plain, const SplittingRow& row);

/// The sweep's finished row with the fewest visits, all kinds together; nullptr for none.
const SplittingRow* best_of_sweep(const SplittingScene& scene);

}  // namespace kerf
