#include "kerf/study/splitting_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "kerf/study/spread.h"

namespace kerf {
namespace {

using Role = SplittingRole;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

constexpr SplittingRowEntry kRows[] = {
    {Role::plain, "plain", "binned_sah", true, false},
    {Role::automatic, "auto", "early_split(auto)+binned_sah", true, true},
    {Role::fast, "fast", "fast+bvh2", false, false},
    {Role::balanced, "balanced", "balanced+bvh2", true, true},
    {Role::best, "best", "best+bvh2", true, true},
    {Role::spatial_split, "SBVH", "spatial_split", true, false},
    {Role::embree_high, "embree_high", "embree_high", false, false},
    {Role::reinsertion, "reinsertion", "binned_sah+reinsertion", false, false},
};

constexpr double kBudgets[] = {1.02, 1.05, 1.1, 1.15, 1.2, 1.3, 1.4, 1.5, 1.6, 1.7, 1.85, 2};

}  // namespace

std::span<const SplittingRowEntry> splitting_study_rows() { return kRows; }

const SplittingRowEntry& splitting_row(SplittingRole role) {
  const auto* const found =
      std::find_if(std::begin(kRows), std::end(kRows), [&](const auto& entry) { return entry.role == role; });
  assert(found != std::end(kRows));
  return *found;
}

std::span<const double> splitting_budgets() { return kBudgets; }

std::string budget_pipeline(double budget) { return fmt::format("early_split(budget={})+binned_sah", budget); }

const SplittingRow* SplittingScene::row(SplittingRole role) const {
  const auto found =
      std::find_if(rows.begin(), rows.end(), [&](const auto& one) { return one.role == role && one.finished; });
  return found == rows.end() ? nullptr : &*found;
}

double visits_share(const SplittingScene& scene, const SplittingRow& row, size_t kind) {
  const SplittingRow* plain = scene.row(Role::plain);
  if (plain == nullptr || kind >= row.rays.size() || !(plain->rays[kind].visits() > 0)) return kUnknown;
  return row.rays[kind].visits() / plain->rays[kind].visits();
}

double visits_share(const SplittingScene& scene, const SplittingRow& row) {
  std::vector<double> shares;
  for (size_t k = 0; k < scene.kinds.size(); ++k) {
    if (scene.ray_counts[k] > 0) shares.push_back(visits_share(scene, row, k));
  }
  return geometric_mean(shares);
}

std::vector<double> paired_speeds(const SplittingRow& base, const SplittingRow& row, size_t kind) {
  if (kind >= base.rays.size() || kind >= row.rays.size()) return {};
  const std::vector<double>&a = base.rays[kind].seconds, &b = row.rays[kind].seconds;
  std::vector<double> speeds;
  for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    if (a[i] > 0 && b[i] > 0) speeds.push_back(a[i] / b[i]);
  }
  return speeds;
}

std::vector<double> paired_speeds(const SplittingScene& scene, const SplittingRow& base, const SplittingRow& row) {
  std::vector<std::vector<double>> kinds;
  for (size_t k = 0; k < scene.kinds.size(); ++k) {
    if (scene.ray_counts[k] > 0) kinds.push_back(paired_speeds(base, row, k));
  }
  size_t runs = kinds.empty() ? 0 : kinds.front().size();
  for (const auto& kind : kinds) runs = std::min(runs, kind.size());
  std::vector<double> speeds;
  for (size_t i = 0; i < runs; ++i) {
    std::vector<double> run;
    run.reserve(kinds.size());
    for (const auto& kind : kinds) run.push_back(kind[i]);
    speeds.push_back(geometric_mean(run));
  }
  return speeds;
}

double splitting_cost(const SplittingRow& plain, const SplittingRow& row) {
  std::vector<double> shares;
  for (size_t i = 0; i < std::min(plain.builds.size(), row.builds.size()); ++i) {
    if (plain.builds[i].total > 0) shares.push_back(row.builds[i].split / plain.builds[i].total);
  }
  return median_of(std::move(shares));
}

const SplittingRow* best_of_sweep(const SplittingScene& scene) {
  const SplittingRow* best = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const SplittingRow& row : scene.rows) {
    if (row.role != Role::budget || !row.finished) continue;
    const double share = visits_share(scene, row);
    if (share < least) {
      least = share;
      best = &row;
    }
  }
  return best;
}

}  // namespace kerf
