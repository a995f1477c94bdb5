// The menu and the grammar of structures.

#include <gtest/gtest.h>

#include "kerf/base/error.h"
#include "kerf/scene/pipeline.h"

namespace kerf {
namespace {

/// The message that a pipeline is refused with; empty if it is taken.
std::string refusal(const std::string& text) {
  try {
    parse_pipeline(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_option);
    return error.what();
  }
  return {};
}

TEST(Menu, EveryEntryHasAUniqueNameAndASentence) {
  for (const MenuEntry& entry : menu()) {
    EXPECT_FALSE(entry.sentence.empty()) << entry.name;
    size_t same = 0;
    for (const MenuEntry& other : menu()) same += other.name == entry.name ? 1 : 0;
    EXPECT_EQ(same, 1U) << entry.name;
    for (const OptionSpec& option : entry.options) {
      OptionValues values(entry.options);
      EXPECT_NO_THROW(values.set(entry.name, option.name, option.fallback)) << entry.name << " " << option.name;
    }
  }
}

TEST(Pipeline, SpellsItselfBack) {
  for (const char* text :
       {"binned_sah", "brute_force", "early_split(sa_max=10)+binned_sah(bins=32)",
        "early_split(budget=1.5)+sweep_sah(leaf=1,depth=40)", "early_split(sa_max=1e-30)+object_median",
        "sweep_sah+reinsertion", "binned_sah+reinsertion(iterations=2)+reinsertion+bvh2",
        "early_split(sa_max=inf)+spatial_median"}) {
    EXPECT_EQ(parse_pipeline(text).text(), text);
  }
  EXPECT_EQ(parse_pipeline(" early_split ( cap = 4 , sa_max = 10.0 ) + binned_sah ( ) ").text(),
            "early_split(sa_max=10,cap=4)+binned_sah");
}

TEST(Pipeline, RefusesWithTheColumnAndTheNearestWord) {
  EXPECT_EQ(refusal("binned_shah"),
            "structure 'binned_shah', column 1: unknown name 'binned_shah'; did you mean 'binned_sah'?");
  EXPECT_EQ(
      refusal("early_split(sa_max=10)+bined_sah"),
      "structure 'early_split(sa_max=10)+bined_sah', column 24: unknown name 'bined_sah'; did you mean 'binned_sah'?");
  EXPECT_EQ(
      refusal("early_split(samax=10)+binned_sah"),
      "structure 'early_split(samax=10)+binned_sah', column 13: early_split: unknown option 'samax'; did you mean "
      "'sa_max'?");
  EXPECT_EQ(refusal("early_split(budget=2)+reinsertion"),
            "structure 'early_split(budget=2)+reinsertion', column 23: a builder must stand before reinsertion, as in "
            "binned_sah+reinsertion");
  EXPECT_EQ(refusal("binned_sah+bvh2+reinsertion"),
            "structure 'binned_sah+bvh2+reinsertion', column 17: nothing can follow a layout");
  EXPECT_NE(refusal("zzz").find("expected fast, balanced, best, early_split, refine, binned_sah"), std::string::npos);
}

TEST(Pipeline, RefusesEveryKindOfMistake) {
  for (const char* text : {"",
                           " ",
                           "+",
                           "binned_sah+",
                           "+binned_sah",
                           "binned_sah(",
                           "binned_sah(bins",
                           "binned_sah(bins=",
                           "binned_sah(bins=32",
                           "binned_sah(bins=32,)",
                           "binned_sah(bins=32)x",
                           "binned_sah binned_sah",
                           "binned_sah(bins=thirty)",
                           "binned_sah(bins=1)",
                           "binned_sah(bins=1.5)",
                           "binned_sah(bins=nan)",
                           "binned_sah(bins=1e999)",
                           "binned_sah(bins=32,bins=16)",
                           "binned_sah+binned_sah",
                           "binned_sah+early_split",
                           "early_split",
                           "early_split+brute_force",
                           "early_split(budget=2)+early_split(budget=2)+binned_sah",
                           "early_split(sa_max=0)+binned_sah",
                           "early_split(sa_max=-1)+binned_sah",
                           "early_split(sa_max=nan)+binned_sah",
                           "early_split(cap=0.5)+binned_sah",
                           "early_split(auto=3)+binned_sah",
                           "early_split(sa_max=automatic)+binned_sah",
                           "brute_force(leaf=4)",
                           "reinsertion",
                           "reinsertion+binned_sah",
                           "early_split(budget=2)+reinsertion",
                           "kd_sah+reinsertion",
                           "binned_sah+reinsertion+binned_sah",
                           "binned_sah+reinsertion+kd_sah",
                           "binned_sah+bvh2+reinsertion",
                           "binned_sah+bvh2+bvh2",
                           "binned_sah,sweep_sah"}) {
    EXPECT_FALSE(refusal(text).empty()) << text;
  }
}

TEST(Pipeline, ListsAreCutOutsideParentheses) {
  const std::vector<std::string> list =
      split_pipeline_list("binned_sah(bins=8,leaf=1),early_split(sa_max=1,cap=2)+sweep_sah");
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0], "binned_sah(bins=8,leaf=1)");
  EXPECT_EQ(list[1], "early_split(sa_max=1,cap=2)+sweep_sah");
  EXPECT_THROW(split_pipeline_list("binned_sah,"), Error);
  EXPECT_THROW(split_pipeline_list(""), Error);
}

TEST(Options, TextIsTheShortestThatReadsBack) {
  EXPECT_EQ(to_text(0.1), "0.1");
  EXPECT_EQ(to_text(32), "32");
  EXPECT_EQ(to_text(std::numeric_limits<double>::infinity()), "inf");
}

}  // namespace
}  // namespace kerf
