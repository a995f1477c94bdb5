// The report on splitting as text: well-formed, complete, and plain about what was missed.

#include "kerf/study/splitting_report.h"

#include <gtest/gtest.h>

#include <regex>

#include "kerf/study/splitting_goals.h"
#include "kerf/study/splitting_tables.h"
#include "tests/support/page_fault.h"
#include "tests/support/splitting_sample.h"

namespace kerf::test {
namespace {

std::vector<SplittingScene> sample() {
  std::vector<SplittingScene> scenes{made_splitting_scene(), made_splitting_scene("a < b & \"c\", d")};
  scenes[1].turn = "x";
  SplittingRow& fast = row_of(scenes[1], SplittingRole::fast);
  fast = {};
  fast.role = SplittingRole::fast;
  fast.why_not = "it takes too many bytes";
  scenes[1].skipped = {"trees: left out as asked"};
  scenes[1].capped_references = 1.5;
  return scenes;
}

TEST(SplittingReport, IsWellFormedNeedsNothingElseAndRepeats) {
  const std::vector<SplittingScene> scenes = sample();
  const SplittingReport report{"Splitting", "kerf study", "a machine", scenes};
  const std::string page = splitting_report(report);
  EXPECT_EQ(fault_of(page), "");
  EXPECT_EQ(page, splitting_report(report));
  EXPECT_FALSE(has(page, "http:") || has(page, "https:"));
  const std::regex id(" id=\"([^\"]+)\"");
  for (std::sregex_iterator i(page.begin(), page.end(), id), end; i != end; ++i) {
    EXPECT_EQ(count_of(page, " id=\"" + (*i)[1].str() + "\""), 1U) << (*i)[1];
  }
  EXPECT_EQ(fault_of(splitting_report({"", "", "", {}})), "");
}

TEST(SplittingReport, HasTheCurvesTheReasonAndWhatWasMissed) {
  const std::vector<SplittingScene> scenes = sample();
  const std::string page = splitting_report({"Splitting", "kerf study", "a machine", scenes});
  EXPECT_EQ(count_of(page, "Visits of all kinds of rays"), 4U) << "a chart and its title in each scene";
  EXPECT_EQ(count_of(page, "Why auto stopped"), 4U);
  EXPECT_TRUE(has(page, "1 % more would gain little"));
  EXPECT_TRUE(has(page, "a &lt; b &amp; &quot;c&quot;, d turned x"));
  EXPECT_TRUE(has(page, "it takes too many bytes"));
  EXPECT_TRUE(has(page, "left out as asked"));
  EXPECT_TRUE(has(page, ">missed<"));
  EXPECT_TRUE(has(page, ">NO<"));
  for (const SplittingRow& row : scenes[0].rows) EXPECT_TRUE(has(page, ">" + row_name(row) + "<")) << row_name(row);
}

TEST(SplittingReport, TextAndValuesHaveEveryRow) {
  const std::vector<SplittingScene> scenes = sample();
  const std::string text = splitting_text(scenes), csv = splitting_csv(scenes);
  EXPECT_TRUE(has(text, "not finished: it takes too many bytes"));
  EXPECT_TRUE(has(text, "R 1.5000"));
  EXPECT_TRUE(has(text, "Why: 1 % more would gain little."));
  const size_t lines = count_of(csv, "\n");
  EXPECT_EQ(lines, 1 + 2 * scenes[0].kinds.size() * scenes[0].rows.size());
  const size_t commas = count_of(csv.substr(0, csv.find('\n')), ",");
  size_t begin = 0;
  for (size_t end = csv.find('\n'); end != std::string::npos; end = csv.find('\n', begin)) {
    std::string line = csv.substr(begin, end - begin);
    line = std::regex_replace(line, std::regex("\"([^\"]|\"\")*\""), "x");
    EXPECT_EQ(count_of(line, ","), commas) << line;
    begin = end + 1;
  }
}

}  // namespace
}  // namespace kerf::test
