// The report of a study as text: what is in it, how it is escaped, that it is well-formed and needs nothing else.
// What it looks like is for tests/browser.

#include "kerf/study/html_report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <regex>
#include <string>
#include <vector>

#include "browser/sample_report.h"
#include "kerf/base/error.h"
#include "support/page_fault.h"

namespace kerf {
namespace {

using test::count_of;
using test::fault_of;
using test::has;

/// The part of the page that is the section of that id.
std::string section_of(const std::string& page, const std::string& id) {
  const size_t begin = page.find("<section id=\"" + id + "\">");
  if (begin == std::string::npos) return "";
  return page.substr(begin, page.find("</section>", begin) - begin);
}

TEST(HtmlReportTest, TheCheckOfFormNotices) {
  const std::string begin = "<!DOCTYPE html>\n";
  EXPECT_EQ(fault_of(begin + "<p>a &amp; b<br/></p>"), "");
  for (const char* wrong :
       {"<p>", "<p><b></p></b>", "<p>a & b</p>", "<p class=x></p>", "<p>a < b</p>", "x", "<p a=\"<\"/>"}) {
    EXPECT_NE(fault_of(begin + wrong), "") << wrong;
  }
}

TEST(HtmlReportTest, IsWellFormedAndRepeats) {
  const StudyReport report = sample_report();
  const std::string page = html_report(report);
  EXPECT_EQ(fault_of(page), "");
  EXPECT_TRUE(page == html_report(report)) << "not the same bytes";
}

TEST(HtmlReportTest, NeedsNothingElse) {
  const std::string page = html_report(sample_report());
  EXPECT_FALSE(has(page, "http:") || has(page, "https:") || has(page, "\"//"));
  EXPECT_FALSE(has(page, "url(") || has(page, "@import") || has(page, "<link") || has(page, "<iframe"));
  EXPECT_EQ(count_of(page, " src=\""), count_of(page, " src=\"data:image/png;base64,iVBORw0KGgo"));
  EXPECT_EQ(count_of(page, " href=\""), count_of(page, " href=\"#"));
}

TEST(HtmlReportTest, LinksLeadSomewhereAndIdsAreUnique) {
  const std::string page = html_report(sample_report());
  const std::regex link("href=\"#([^\"]+)\""), id(" id=\"([^\"]+)\"");
  for (std::sregex_iterator i(page.begin(), page.end(), link), end; i != end; ++i) {
    EXPECT_EQ(count_of(page, " id=\"" + (*i)[1].str() + "\""), 1U) << (*i)[1];
  }
  for (std::sregex_iterator i(page.begin(), page.end(), id), end; i != end; ++i) {
    EXPECT_EQ(count_of(page, " id=\"" + (*i)[1].str() + "\""), 1U) << (*i)[1];
  }
}

TEST(HtmlReportTest, ShowsOncePerSceneHowFarAutomaticSplittingWentAndWhy) {
  const std::string page = html_report(sample_report());
  const std::string section = section_of(page, "scene-1");
  EXPECT_EQ(count_of(section, "How far automatic splitting went"), 1U);
  EXPECT_EQ(count_of(section, "1 % more would gain &quot;too&quot; little."), 1U);
  EXPECT_EQ(count_of(section, ">chosen<"), 1U);
}

TEST(HtmlReportTest, HasEveryRowOfEveryScene) {
  const StudyReport report = sample_report();
  const std::string page = html_report(report);
  const std::regex breaks("<wbr( class=\"narrow\")?/>");
  const std::string plain = std::regex_replace(page, breaks, "");
  for (const auto& [id, kinds] : {std::pair{"scene-1", 2U}, {"scene-2", 1U}, {"scene-3", 1U}}) {
    const std::string section = section_of(plain, id);
    EXPECT_EQ(count_of(section, "<table"), kinds);
    for (size_t row = 0; row < 14; ++row) {
      const std::string head =
          "<b class=\"number\">" + std::to_string(row + 1) + "</b> <code>" + report.results[row].row + "</code>";
      EXPECT_EQ(count_of(section, head), kinds) << head;
    }
  }
  EXPECT_EQ(count_of(page, "<h2>"), 7U);
  EXPECT_EQ(count_of(section_of(page, "overview"), "<tr"), 15U);
  EXPECT_EQ(count_of(section_of(page, "sweep"), "<tr"), 8U);
  EXPECT_EQ(count_of(section_of(page, "growth"), "<tr"), 71U);
}

TEST(HtmlReportTest, SaysWhyARowDidNotFinish) {
  StudyReport report;
  report.results = {sample_result("s", "binned_sah"), sample_result("s", "kd_sah")};
  report.results[1].finished = false;
  report.results[1].why_not = "the limit of 3 < 4 seconds";
  const std::string page = html_report(report);
  EXPECT_TRUE(has(page, "<b>not finished</b>: the limit of 3 &lt; 4 seconds"));
  EXPECT_TRUE(has(page, "1 of 2 rows did not finish."));
  EXPECT_EQ(count_of(page, "class=\"missing\""), 3U) << "in each chart of bars";
  report.results[0].finished = false;
  EXPECT_EQ(fault_of(html_report(report)), "");
  EXPECT_EQ(count_of(html_report(report), "<figure"), 0U) << "nothing to draw";
}

TEST(HtmlReportTest, EscapesAllText) {
  const std::string evil = "<b>&\"'</b>\x01\xFF";
  const std::string safe = "&lt;b&gt;&amp;&quot;&#39;&lt;/b&gt;\xEF\xBF\xBD\xEF\xBF\xBD";
  StudyReport report;
  report.title = report.command = report.machine = evil;
  report.notes = {evil};
  report.results = {sample_result(evil, evil), sample_result("other", evil)};
  report.results[0].rays = evil;
  report.results[1].finished = false;
  report.results[1].why_not = evil;
  report.sweep = report.growth = report.results;
  report.pictures = {{evil, evil, {1, 1, 1, {0.5F}}}};
  const std::string page = html_report(report);
  EXPECT_EQ(fault_of(page), "");
  EXPECT_FALSE(has(page, "<b>&"));
  EXPECT_TRUE(has(page, "<h1>" + safe + "</h1>"));
  EXPECT_TRUE(has(page, "alt=\"" + safe + ": " + safe + "\""));
  EXPECT_TRUE(has(page, "<code>" + safe + "</code>"));
}

TEST(HtmlReportTest, ShowsWhatThePaperPrinted) {
  StudyReport report;
  report.results = {sample_result("s", "binned_sah"), sample_result("s", "kd_sah")};
  report.results[0].nodes_per_ray = 50;
  report.results[1].nodes_per_ray = 40;
  report.results[0].paper = PaperRow{1, NAN, 100, 0, 4, 1};
  const std::string page = html_report(report);
  EXPECT_TRUE(
      has(page, "<span>50.0</span><span class=\"paper\">paper 100<span class=\"ratio\">ours 0.500\xC3\x97</span>"));
  EXPECT_EQ(count_of(page, "<span class=\"paper\">"), 5U) << "one that is no number is not shown";
  EXPECT_EQ(count_of(page, "class=\"paper-mark\""), 1U);
}

TEST(HtmlReportTest, ShowsSpreadsAndTheBest) {
  StudyReport report;
  report.results = {sample_result("s", "binned_sah"), sample_result("s", "kd_sah")};
  report.results[0].trace_seconds = {2, 1.5, 3, 5};
  report.results[1].trace_seconds = {1, 0.9, 1.1, 5};
  report.results[1].speedup = 2;
  std::string page = html_report(report);
  EXPECT_TRUE(has(page,
                  "<span>2.00</span><span class=\"range\">1.50\xE2\x80\x89\xE2\x80\x93\xE2\x80\x89"
                  "3.00</span>"));
  EXPECT_TRUE(has(page, "<strong>1.00</strong>"));
  EXPECT_TRUE(has(page, "<strong>2.00\xC3\x97</strong>"));
  EXPECT_TRUE(has(page, ", 2.00 times as fast as <b>1</b> <code>binned_sah</code>"));
  EXPECT_FALSE(has(page, "chance may have ordered"));
  report.results[1].trace_seconds.most = 1.6;
  page = html_report(report);
  EXPECT_TRUE(has(page, "Its runs overlap those of 1: chance may have ordered them."));
}

TEST(HtmlReportTest, WarnsWhereRowsDisagreeAboutHits) {
  StudyReport report;
  report.results = {sample_result("s", "binned_sah"), sample_result("s", "kd_sah")};
  EXPECT_TRUE(has(html_report(report), "All 2 rows that finished found the same number of hits, 812,345."));
  report.results[1].hits = 812344;
  const std::string page = html_report(report);
  EXPECT_FALSE(has(page, "the same number of hits"));
  EXPECT_TRUE(has(page, "do not agree on the number of hits: from 812,344 to 812,345."));
}

TEST(HtmlReportTest, NothingAndLittle) {
  StudyReport report;
  EXPECT_EQ(fault_of(html_report(report)), "");
  EXPECT_TRUE(has(html_report(report), "This study has no results."));
  report.pictures = {{"only a picture", "", {2, 1, 3, {0, 0, 0, 1, 1, 1}}}};
  EXPECT_TRUE(has(html_report(report), "<h2>only a picture</h2>"));
  report.results = {StudyResult{}};
  report.growth = report.sweep = report.results;
  EXPECT_EQ(fault_of(html_report(report)), "");
}

TEST(HtmlReportTest, ZerosInfinitiesAndNaNs) {
  constexpr double kValues[] = {0, -0.0, INFINITY, -INFINITY, NAN, 5e-324, 1.7e308, -1, 1e-12, 1e15};
  const std::regex odd_place(" (?:x|y|cx|cy|d|r|width|height|viewBox|transform)=\"[^\"]*(?:nan|inf|e\\+|e-)");
  StudyReport report;
  for (const double a : kValues) {
    for (const double b : {a, 1.0}) {
      StudyResult result = sample_result("s", "row " + std::to_string(report.results.size()));
      result.references_per_triangle = result.nodes_per_ray = result.sah_cost = a;
      result.triangles_per_ray = result.boxes_per_ray = result.speedup = b;
      result.build_seconds = {a, b, a, 3};
      result.trace_seconds = {b, a, b, 3};
      result.end_point_overlap = a;
      result.sa_max = b;
      result.paper = PaperRow{a, b, a, b, a, b};
      report.results.push_back(result);
      const StudyReport alone{"", "", "", {result}, {result}, {result, sample_result("s", "x")}, {}, {}};
      const std::string page = html_report(alone);
      EXPECT_EQ(fault_of(page), "") << a;
      EXPECT_FALSE(std::regex_search(page, odd_place)) << a;
    }
  }
  report.sweep = report.growth = report.results;
  const std::string page = html_report(report);
  EXPECT_EQ(fault_of(page), "");
  EXPECT_FALSE(std::regex_search(page, odd_place));
  EXPECT_TRUE(has(page, "points have no place on these axes"));
}

TEST(HtmlReportTest, APictureThatIsNoneIsAnError) {
  StudyReport report;
  report.pictures = {{"s", "empty one", {}}};
  try {
    html_report(report);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
    EXPECT_EQ(error.place(), "picture 'empty one'");
  }
}

}  // namespace
}  // namespace kerf
