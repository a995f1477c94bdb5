// What a build tells where a limit of bytes keeps a splitter or a builder from cuts: only that, and the same for any
// number of threads.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "kerf/scene/scene.h"
#include "tests/support/random_scene.h"

namespace kerf::test {
namespace {

using Stages = std::vector<std::string>;

/// Long thin triangles, which lie askew: their boxes are nearly empty.
class ShortOfRoom : public testing::Test {
 protected:
  ShortOfRoom() { scene_.add(needles_.geometry()); }

  BuildReport build(const std::string& structure, size_t bytes = static_cast<size_t>(-1), int threads = 0) {
    BuildOptions options;
    options.structure = structure;
    options.threads = threads;
    options.limit.bytes = bytes;
    return scene_.build(options);
  }
  size_t least(const std::string& structure) const { return scene_.memory_need({.structure = structure}).least; }

  const RandomTriangles needles_{6000, 1, 1.0F};
  Scene scene_;
};

TEST_F(ShortOfRoom, IsSaidOfABuilderThatWouldCutMore) {
  const std::string structure = "spatial_split(cap=4)";
  const BuildReport tight = build(structure, least(structure) * 3 / 2);
  EXPECT_EQ(tight.short_of_room, Stages{"spatial_split"});
  EXPECT_FALSE(tight.capped) << "there is no splitter";
  EXPECT_LT(tight.references, build(structure).references);
}

TEST_F(ShortOfRoom, IsNotSaidWithoutNeed) {
  for (const char* structure : {"spatial_split(cap=4)", "spatial_split(cap=64)", "early_split(budget=2)+binned_sah",
                                "early_split(auto)+spatial_split", "best"}) {
    EXPECT_EQ(build(structure).short_of_room, Stages{}) << structure;
  }
  // Not even below what the cap allows, where fewer are wanted: then the tree is that without a limit.
  for (const char* structure :
       {"spatial_split(cap=64,overlap=0.05)", "spatial_split(overlap=1)", "early_split(sa_max=1e30)+binned_sah"}) {
    const BuildReport free = build(structure);
    const BuildReport limited = build(structure, least(structure) * 40);
    EXPECT_LT(least(structure), scene_.memory_need({.structure = structure}).most);
    EXPECT_EQ(limited.short_of_room, Stages{}) << structure;
    EXPECT_EQ(limited.tree_hash, free.tree_hash) << structure;
  }
}

/// Every limit here is below what the cap allows. Where no cut was refused the tree is that without a limit.
TEST_F(ShortOfRoom, IsSaidExactlyWhereTheTreeIsAnotherOne) {
  size_t said = 0, unsaid = 0;
  for (const char* overlap : {"1e-05", "0.01", "0.05", "0.2", "0.4"}) {
    const std::string structure = std::string("spatial_split(cap=8,overlap=") + overlap + ")";
    const BuildReport free = build(structure);
    for (const size_t eighths : {9, 10, 12, 14, 16, 24, 48}) {
      const BuildReport report = build(structure, least(structure) * eighths / 8);
      const bool is_short = !report.short_of_room.empty();
      EXPECT_EQ(is_short, report.tree_hash != free.tree_hash) << structure << " " << eighths;
      const bool had_less_than_twice = eighths < 16;  // else no first cut can lack room
      said += is_short ? 1 : 0;
      unsaid += !is_short && had_less_than_twice && report.references > report.primitives ? 1 : 0;
    }
  }
  EXPECT_GT(said, 3U);
  EXPECT_GT(unsaid, 3U);
}

TEST_F(ShortOfRoom, IsNotSaidWhereOnlyTheCapStops) {
  const BuildReport builder = build("spatial_split(cap=1.2)", least("spatial_split") * 2);
  EXPECT_EQ(builder.short_of_room, Stages{});
  EXPECT_LE(builder.references_per_primitive, 1.2);
  EXPECT_LT(builder.references, build("spatial_split(cap=1.5)").references);
  for (const char* structure :
       {"early_split(sa_max=0.01,cap=1.2)+binned_sah", "early_split(auto,cap=1.1)+binned_sah"}) {
    const BuildReport splitter = build(structure, least(structure) * 2);
    EXPECT_TRUE(splitter.capped) << structure;
    EXPECT_EQ(splitter.short_of_room, Stages{}) << structure;
  }
}

TEST_F(ShortOfRoom, NamesEachStage) {
  for (const char* splitter : {"early_split(sa_max=0.01)", "early_split(budget=4)", "early_split(auto)",
                               "refine(edge=0.01)", "refine(budget=4)"}) {
    const std::string structure = std::string(splitter) + "+binned_sah";
    const BuildReport report = build(structure, least(structure) * 11 / 10);
    EXPECT_TRUE(report.capped) << structure;
    EXPECT_EQ(report.short_of_room, Stages{structure.substr(0, structure.find('('))}) << structure;
    if (report.choice) {
      EXPECT_NE(report.choice->reason.find("the limit of bytes"), std::string::npos) << report.choice->reason;
    }
  }
  const std::string both = "early_split(budget=4)+spatial_split";
  EXPECT_EQ(build(both, least(both) * 3 / 2).short_of_room, (Stages{"early_split", "spatial_split"}));
  EXPECT_EQ(room_sentence(scene_.report().short_of_room),
            "the limit of bytes left early_split and spatial_split no room to cut as the options allow");
}

TEST_F(ShortOfRoom, IsTheSameForAnyNumberOfThreads) {
  const std::string structure = "spatial_split(cap=4)";
  for (const size_t eighths : {9, 12, 16, 24, 30}) {
    const size_t bytes = least(structure) * eighths / 8;
    const BuildReport one = build(structure, bytes, 1);
    for (const int threads : {2, 3}) {
      const BuildReport more = build(structure, bytes, threads);
      EXPECT_EQ(more.short_of_room, one.short_of_room) << eighths;
      EXPECT_EQ(more.tree_hash, one.tree_hash) << eighths;
    }
  }
}

/// Automatic splitting that would cut nothing anyway has given nothing up.
TEST(ShortOfRoomAlone, IsNotSaidWhereCutsWouldNotSaveEnough) {
  const RandomTriangles dust(6000, 1, 0);
  Scene scene;
  scene.add(dust.geometry());
  BuildOptions options;
  options.structure = "early_split(auto)+binned_sah";
  const bool is_cut = scene.build(options).references_per_primitive > 1;
  options.limit.bytes = scene.memory_need(options).least;
  EXPECT_EQ(!scene.build(options).short_of_room.empty(), is_cut) << scene.report().choice->reason;
}

}  // namespace
}  // namespace kerf::test
