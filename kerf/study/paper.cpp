// Ernst, Greiner: Early Split Clipping for Bounding Volume Hierarchies, 2007, Table 1.

#include "kerf/study/paper.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "kerf/base/error.h"
#include "kerf/references/early_split.h"
#include "kerf/render/render_scene.h"
#include "kerf/scene/menu.h"
#include "kerf/study/camera_list.h"
#include "kerf/study/models/models.h"
#include "kerf/study/turn.h"

namespace kerf {
namespace {

constexpr PaperTableScene kTable[] = {
    {"Bunny",
     69451,
     {"bvh inf", {1.00, 0.57, 28.6, 1.33, 1.63, 1.00}},
     {"bvh 3", {1.50, 1.00, 29.6, 1.15, 1.63, 1.00}},
     {"bvh 1", {3.52, 2.80, 30.8, 0.96, 1.68, 0.97}},
     {"kd-tree", {10.60, 8.75, 47.8, 2.00, 1.65, 0.98}}},
    {"Mirror low",
     85651,
     {"bvh inf", {1.00, 0.80, 60.6, 9.73, 4.37, 1.00}},
     {"bvh 100", {1.25, 1.01, 41.0, 2.32, 2.25, 1.94}},
     {"bvh 10", {3.44, 3.43, 37.9, 1.13, 1.98, 2.20}},
     {"kd-tree", {13.39, 13.6, 30.9, 4.73, 1.70, 2.57}}},
    {"Mirror high",
     334080,
     {"bvh inf", {1.00, 3.34, 48.0, 4.99, 3.05, 1.00}},
     {"bvh 100", {1.04, 3.60, 44.5, 3.05, 2.55, 1.19}},
     {"bvh 10", {1.68, 6.46, 40.4, 1.54, 2.16, 1.41}},
     {"kd-tree", {11.53, 50.9, 34.7, 3.53, 1.63, 1.87}}},
    {"Power plant",
     1667578,
     {"bvh inf", {1.00, 20.6, 193, 58.2, 18.0, 1.00}},
     {"bvh 1e6", {1.49, 32.8, 160, 9.86, 7.84, 2.29}},
     {"bvh 1e5", {4.88, 123.0, 127, 3.12, 5.39, 3.33}},
     {"kd-tree", {10.01, 176.7, 96.8, 15.6, 4.20, 4.28}}},
};
constexpr const PaperTableScene &kBunny = kTable[0], &kMirrorLow = kTable[1], &kMirrorHigh = kTable[2],
                                &kPlant = kTable[3];

constexpr double kNear = 1.5;  // how far a stand-in may be off
constexpr double kSweepBudgets[] = {1.05, 1.1, 1.2, 1.35, 1.5, 1.75, 2, 2.5, 3, 4, 6, 10};

SceneDescription bare(Mesh mesh, const std::string& place) {
  SceneDescription scene;
  scene.is_lit = false;
  scene.materials.emplace_back();
  scene.objects.push_back({std::move(mesh), 0, true, place});
  return scene;
}

PaperStandIn made(const std::string& name, const PaperTableScene& paper, const char* model, int seed) {
  return {name, &paper, [=, &paper] { return made_scene(name, model, paper.triangles, static_cast<uint64_t>(seed)); }};
}

/// The stand-in from a file, if a folder has it.
std::optional<PaperStandIn> found(const char* name, const PaperTableScene& paper,
                                  std::span<const std::string> folders) {
  for (const std::string& folder : folders) {
    const std::string path = (std::filesystem::path(folder) / (std::string(name) + ".ply")).string();
    if (!std::filesystem::exists(path)) continue;
    return PaperStandIn{name, &paper, [path, name = std::string(name)] {
                          StudyScene scene{name, read_scene(path), {}};
                          const std::optional<Camera> camera = listed_camera(path);
                          if (!camera) throw Error(ErrorCode::file, path, "cameras.tsv beside it has no row for it");
                          scene.camera = *camera;
                          return scene;
                        }};
  }
  return std::nullopt;
}

PaperStandIn turned_stand_in(const PaperStandIn& straight) {
  const std::string name = straight.name + " turned xyz";
  return {name, straight.paper, [name, load = straight.load] {
            const Transform turn = turn_by_name("xyz");
            StudyScene scene = load();
            return StudyScene{name, turned(std::move(scene.description), turn), turned(scene.camera, turn)};
          }};
}

bool is_in_menu(std::string_view name) {
  const std::span<const MenuEntry> all = menu();
  return std::any_of(all.begin(), all.end(), [&](const MenuEntry& entry) { return entry.name == name; });
}

}  // namespace

StudyScene made_scene(const std::string& name, const std::string& model, uint64_t triangles, uint64_t seed) {
  MadeModel made = make_model(model, triangles, seed);
  return {name, bare(std::move(made.mesh), model), made.camera};
}

std::span<const PaperTableScene> paper_table() { return kTable; }

std::vector<PaperStandIn> paper_stand_ins(std::span<const std::string> folders, int seeds,
                                          std::vector<std::string>& notes) {
  std::vector<PaperStandIn> all;
  const auto add_found = [&](const char* name, const PaperTableScene& paper, const char* how) {
    if (auto stand_in = found(name, paper, folders)) {
      all.push_back(std::move(*stand_in));
    } else {
      notes.push_back(fmt::format("{} is not here{}", name, how));
    }
  };
  add_found("bunny", kBunny, ": scenes/get bunny");
  all.push_back(made("mirror low", kMirrorLow, "mirror", 1));
  all.push_back(made("mirror high", kMirrorHigh, "mirror", 1));
  add_found("housing_coarse", kMirrorLow, ": scenes/get housing");
  add_found("housing_fine", kMirrorHigh, ": scenes/get housing");
  for (int seed = 1; seed <= seeds; ++seed) {
    all.push_back(made(seeds > 1 ? fmt::format("plant, seed {}", seed) : "plant", kPlant, "plant", seed));
    all.back().is_made_plant = true;
  }
  for (const char* name : {"sanmiguel", "tower_bridge"}) {
    add_found(name, kPlant, "");
    if (!all.empty() && all.back().name == name) all.push_back(turned_stand_in(all.back()));
  }
  return all;
}

std::string stand_in_verdict(const PaperTableScene& paper, std::span<const StudyResult> results) {
  const auto plain = std::find_if(results.begin(), results.end(), [](const StudyResult& result) {
    return result.finished && result.row == "binned_sah" && result.rays == "primary";
  });
  if (plain == results.end()) return {};
  const PaperRow& figures = paper.plain.figures;
  const double nodes = plain->nodes_per_ray / figures.nodes_per_ray;
  const double triangles = plain->triangles_per_ray / figures.triangles_per_ray;
  const auto is_near = [](double ratio) { return ratio <= kNear && ratio >= 1 / kNear; };
  const bool counts = is_near(nodes) && is_near(triangles);
  return fmt::format(
      "{}: its plain tree has {:.3g} nodes and {:.3g} triangle tests a ray, {:.2f} and {:.2f} times those of the "
      "paper's {}: it {} as a stand-in (within a factor of {})",
      plain->scene, plain->nodes_per_ray, plain->triangles_per_ray, nodes, triangles, paper.name,
      counts ? "counts" : "does not count", kNear);
}

double sa_max_for(const SceneDescription& scene, double budget) {
  const Scene probe = build_scene(scene, {.structure = "brute_force", .skip_invalid = true});
  const std::span<const Geometry> geometries = probe.geometries();
  const std::vector<Reference> whole = make_references(geometries, true).references;
  const double sa_max = early_split(whole, geometry_clipper(geometries), EarlySplit::with_budget(budget)).limit;
  return std::stod(fmt::format("{:.4g}", sa_max));
}

std::vector<PaperStudyRow> paper_rows(const SceneDescription& scene, const PaperTableScene& paper) {
  std::vector<PaperStudyRow> rows{{"binned_sah", paper.plain.figures}};
  for (const PaperTableRow* row : {&paper.coarse, &paper.fine}) {
    const double sa_max = sa_max_for(scene, row->figures.references_per_triangle);
    rows.push_back({fmt::format("early_split(sa_max={},cap=1000)+binned_sah", sa_max), row->figures});
  }
  const double coarse = paper.coarse.figures.references_per_triangle;
  const auto add = [&](std::string_view name, const std::string& pipeline, std::optional<PaperRow> figures = {}) {
    if (is_in_menu(name)) rows.push_back({pipeline, figures});
  };
  add("kd_sah", "kd_sah(mailbox=off)", paper.kd_tree.figures);
  add("kd_sah", "kd_sah(mailbox=on)");
  add("late_split", fmt::format("binned_sah+late_split(budget={},restore=on)", coarse));
  add("late_split", fmt::format("binned_sah+late_split(budget={},restore=off)", coarse));
  add("refine", fmt::format("refine(budget={})+binned_sah", coarse));
  add("embree_medium", "embree_medium");
  add("embree_high", "embree_high");
  return rows;
}

std::vector<std::string> sweep_rows(const SceneDescription& scene) {
  std::vector<std::string> rows{"binned_sah"};
  for (const double budget : kSweepBudgets) {
    rows.push_back(fmt::format("early_split(sa_max={},cap=1000)+binned_sah", sa_max_for(scene, budget)));
  }
  // A scene of few large triangles may have the same limit twice.
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  return rows;
}

}  // namespace kerf
