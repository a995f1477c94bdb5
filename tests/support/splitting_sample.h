#pragma once

#include <string>
#include <vector>

#include "kerf/study/splitting_result.h"

namespace kerf::test {

/// The row of that role, of that budget where one is given.
inline SplittingRow& row_of(SplittingScene& scene, SplittingRole role, double budget = 0) {
  for (SplittingRow& row : scene.rows) {
    if (row.role == role && row.budget == budget) return row;
  }
  scene.rows.emplace_back();
  scene.rows.back().role = role;
  scene.rows.back().budget = budget;
  return scene.rows.back();
}

/// Adds a finished row: as many visits per ray in each kind of rays, seconds for 15 runs over them, builds of `build`
/// seconds of which `split` go into splitting. A fourth of the visits are triangles.
inline SplittingRow& add_row(SplittingScene& scene, SplittingRole role, double visits, double seconds, double build,
                             double split = 0, double budget = 0) {
  SplittingRow& row = row_of(scene, role, budget);
  row.pipeline = budget > 0 ? budget_pipeline(budget) : std::string(splitting_row(role).pipeline);
  row.finished = true;
  row.why_not.clear();
  row.references_per_primitive = budget > 0 ? budget : 1.3;
  row.sah_cost = 100;
  row.bytes = 1000;
  row.tree_hash = 7;
  for (int i = 0; i < 3; ++i) row.builds.push_back({0, split, build - split, 0, 0, build});
  const bool is_timed = budget == 0 && splitting_row(role).is_timed;
  for (size_t k = 0; k < scene.kinds.size(); ++k) {
    row.rays.push_back({visits * 0.75, visits * 0.25, 50, std::vector<double>(is_timed ? 15 : 0, seconds)});
  }
  return row;
}

/// A scene that was not measured by anything and reaches every goal that is asked of it: automatic splitting halves the
/// work.
inline SplittingScene made_splitting_scene(const std::string& name = "hall") {
  using Role = SplittingRole;
  SplittingScene scene;
  scene.name = name;
  scene.turn = "straight";
  scene.triangles = 200000;
  scene.kinds = {"primary", "shadow"};
  scene.ray_counts = {100, 80};
  SplittingRow& plain = add_row(scene, Role::plain, 40, 2, 1);
  plain.references_per_primitive = 1;
  SplittingRow& automatic = add_row(scene, Role::automatic, 20, 1, 1.4, 0.2);
  automatic.choice = SplitChoice{{{1, 30}, {1.3, 20}}, "1 % more would gain little"};
  add_row(scene, Role::fast, 22, 1, 0.3);
  add_row(scene, Role::balanced, 20, 1, 1.2, 0.2).peak_bytes = 2000;
  add_row(scene, Role::best, 15, 0.75, 6);
  add_row(scene, Role::spatial_split, 19, 0.96, 4);
  add_row(scene, Role::embree_high, 19, 1, 9);
  add_row(scene, Role::reinsertion, 36, 1.8, 1.5).sah_cost = 85;
  for (const double budget : splitting_budgets()) {
    add_row(scene, Role::budget, 20 + 10 * (2 - budget), 1, 1.5, 0.3, budget);
  }
  scene.variants = {{"1e-3 times the size", 1.3}, {"1e6 times the size", 1.301}, {"axes exchanged", 1.3}};
  scene.capped_references = 1.2;
  for (const Role role : {Role::automatic, Role::balanced, Role::best}) {
    scene.trees.push_back({role, {1, 2, 7}, {7, 7, 7}});
  }
  scene.refusal = SplittingRefusal{200000, true, 0.001, "it needs 40000000 bytes, and 200000 are allowed"};
  return scene;
}

}  // namespace kerf::test
