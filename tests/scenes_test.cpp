// Trees over real scenes: the same for any number of threads, different for each builder, ordered by cost.

#include <gtest/gtest.h>

#include <unistd.h>

#include <set>
#include <string>
#include <utility>

#include "kerf/build/builders.h"
#include "kerf/io/ply.h"
#include "kerf/scene/scene.h"
#include "tests/support/scenes.h"

namespace kerf {
namespace {

/// A scene of the folder that KERF_SCENES names; the test is skipped where it is not there.
class RealScene : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const std::optional<std::string> folder = test::scenes_folder();
    const std::string path = folder.value_or("") + "/" + GetParam() + ".ply";
    if (!folder || access(path.c_str(), R_OK) != 0) {
      GTEST_SKIP() << GetParam() << ".ply is not in KERF_SCENES";
    }
    mesh_ = read_ply(path);
  }

  BuildReport build(const std::string& structure, int threads = 0) const {
    Scene scene;
    scene.add(TriangleMesh{std::span(mesh_.vertices), std::span(mesh_.triangles)});
    return scene.build({.structure = structure, .threads = threads});
  }

  Mesh mesh_;
};

INSTANTIATE_TEST_SUITE_P(Scenes, RealScene,
                         testing::Values("sponza", "staircase", "housing_coarse", "bunny", "engine", "fzk_haus"),
                         [](const auto& entry) { return std::string(entry.param); });

TEST_P(RealScene, TreeDoesNotDependOnThreads) {
  if (mesh_.triangles.size() > 100000) GTEST_SKIP() << "one of the smaller scenes says it too";
  for (const BuilderEntry& builder : builders()) {
    const std::string structure = "early_split(budget=1.5)+" + std::string(builder.name);
    const uint64_t one = build(structure, 1).tree_hash;
    EXPECT_EQ(build(structure, 2).tree_hash, one) << builder.name;
    EXPECT_EQ(build(structure, 7).tree_hash, one) << builder.name;
  }
}

TEST_P(RealScene, BuildersMakeDifferentTreesOrderedByCost) {
  // Greedy choices with more candidates are not always better in the end. The goal is 1 %; two exceptions were
  // measured: the sweep is 2.8 % above 31 planes on plain sponza and 1.3 % on split staircase.
  const std::string scene = GetParam();
  const double plain = scene == "sponza" ? 1.03 : 1.01, split = scene == "staircase" ? 1.02 : 1.01;
  for (const auto& [prefix, slack] : {std::pair<std::string, double>("", plain), {"early_split(budget=1.5)+", split}}) {
    std::set<uint64_t> hashes;
    const auto cost = [&](const char* builder) {
      const BuildReport report = build(prefix + builder);
      hashes.insert(report.tree_hash);
      return report.sah_cost;
    };
    const double sweep = cost("sweep_sah"), fine = cost("binned_sah(planes=31)"), coarse = cost("binned_sah(planes=8)");
    const double spatial = cost("spatial_median"), object = cost("object_median");
    EXPECT_EQ(hashes.size(), 5U);
    EXPECT_LE(sweep, fine * slack);
    EXPECT_LE(fine, coarse * 1.01);
    EXPECT_LE(coarse, spatial * 1.01);
    EXPECT_LE(coarse, object * 1.01);
    std::printf("%s%s: SAH cost sweep %.2f, 31 planes %.2f, 8 planes %.2f, spatial median %.2f, object median %.2f\n",
                prefix.c_str(), GetParam(), sweep, fine, coarse, spatial, object);
  }
}

}  // namespace
}  // namespace kerf
