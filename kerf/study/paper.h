#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kerf/study/study.h"

namespace kerf {

/// One row of Table 1 of Ernst and Greiner 2007.
struct PaperTableRow {
  std::string_view label;  ///< as printed: "bvh 100"
  PaperRow figures;
};

/// One scene of that table: a plain BVH, two surface area limits, a kd-tree.
struct PaperTableScene {
  std::string_view name;
  size_t triangles;
  PaperTableRow plain, coarse, fine, kd_tree;
};

/// The whole table.
std::span<const PaperTableScene> paper_table();

/// A model of kerf make as a scene of a study.
StudyScene made_scene(const std::string& name, const std::string& model, uint64_t triangles, uint64_t seed);

/// A scene to hold against one of the paper's.
struct PaperStandIn {
  std::string name;
  const PaperTableScene* paper;
  std::function<StudyScene()> load;
  bool is_made_plant = false;
};

/// Whether a made plant counts as a stand-in: its plain tree's nodes and triangle tests per ray within a factor of 1.5
/// of the paper's. A sentence with the figures; empty if the plain row did not finish.
std::string stand_in_verdict(const PaperTableScene& paper, std::span<const StudyResult> results);

/// The stand-ins that can be had here: made ones (the mirror at two levels, the plant, for `seeds` seeds), the bunny
/// and others from the first of `folders` that has NAME.ply, the two largest turned too. What is missing is told in
/// `notes`, a sentence each.
std::vector<PaperStandIn> paper_stand_ins(std::span<const std::string> folders, int seeds,
                                          std::vector<std::string>& notes);

/// A row of a study and what the paper printed for it, if anything.
struct PaperStudyRow {
  std::string pipeline;
  std::optional<PaperRow> paper;
};

/// The paper's rows for a scene: the surface area limits are those that give its reference ratios here, found by
/// bisection; kd-tree with and without mailboxes; late splitting and refinement; Embree's trees where it is installed.
std::vector<PaperStudyRow> paper_rows(const SceneDescription& scene, const PaperTableScene& paper);

/// The surface area limit, to four digits, at which early splitting gives `budget` references per primitive.
double sa_max_for(const SceneDescription& scene, double budget);

/// Rows early_split(sa_max=...)+binned_sah for a curve over R, from 1 to about 10, the plain one first.
std::vector<std::string> sweep_rows(const SceneDescription& scene);

}  // namespace kerf
