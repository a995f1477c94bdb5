// KERF_ISA: what runs is what it names, and a word that is wrong is told.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "kerf/base/instruction_set.h"
#include "kerf/scene/scene.h"
#include "tests/support/environment.h"
#include "tests/support/error_of.h"
#include "tests/support/random_scene.h"

namespace kerf::test {
namespace {

constexpr const char* kVariable = "KERF_ISA";

std::string built_with(const std::string& structure) {
  const RandomTriangles triangles(20);
  Scene scene;
  scene.add(triangles.geometry());
  return scene.build({.structure = structure}).instruction_set;
}

TEST(InstructionSet, TheBestIsTakenAndAnyOtherCanBe) {
  const ScopedVariable none(kVariable, "");
  const std::vector<std::string_view> all = instruction_sets();
  ASSERT_FALSE(all.empty());
  EXPECT_EQ(chosen_instruction_set().name, all.front());
  for (const std::string structure : {"binned_sah+bvh4", "binned_sah+bvh8", "brute_force"}) {
    EXPECT_EQ(built_with(structure), all.front()) << structure;
    for (const std::string_view set : all) {
      const ScopedVariable one(kVariable, std::string(set));
      EXPECT_EQ(built_with(structure), set) << structure;
      EXPECT_EQ(built_with("binned_sah"), "scalar");
    }
  }
}

TEST(InstructionSet, EachHasItsOwnKernels) {
  const std::vector<std::string_view> all = instruction_sets();
  for (size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(std::count(all.begin(), all.end(), all[i]), 1) << all[i];
    const ScopedVariable one(kVariable, std::string(all[i]));
    const size_t place = chosen_instruction_set().place;
    for (size_t k = 0; k < i; ++k) {
      const ScopedVariable other(kVariable, std::string(all[k]));
      EXPECT_NE(chosen_instruction_set().place, place) << all[i] << ", " << all[k];
    }
  }
}

TEST(InstructionSet, CapitalsDoNotMatter) {
  std::string name(instruction_sets().back());
  std::transform(name.begin(), name.end(), name.begin(), [](char c) { return static_cast<char>(std::toupper(c)); });
  const ScopedVariable one(kVariable, name);
  EXPECT_EQ(chosen_instruction_set().name, instruction_sets().back());
}

TEST(InstructionSet, AWordThatIsNoneIsAnErrorOfEveryBuild) {
  const std::string best(instruction_sets().front());
  const ScopedVariable wrong(kVariable, best + "x");
  for (const std::string structure : {"binned_sah", "binned_sah+bvh8", "brute_force"}) {
    const std::string words = error_of(ErrorCode::invalid_option, [&] { built_with(structure); });
    EXPECT_EQ(words, "KERF_ISA: this machine has no instruction set '" + best + "x'; did you mean '" + best + "'?");
  }
  const ScopedVariable absurd(kVariable, "qqqqqqqqqqqqqqqqqqqq");
  const std::string words = error_of(ErrorCode::invalid_option, [&] { built_with("binned_sah"); });
  EXPECT_NE(words.find("; expected " + best), std::string::npos) << words;
}

}  // namespace
}  // namespace kerf::test
