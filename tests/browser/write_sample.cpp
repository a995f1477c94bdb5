// Writes a report of invented figures for the browser: write_sample KIND FILE.
// KIND: full, empty, one (a single row), odd (zeros, infinities, NaN, long and hostile names, nothing finished),
// splitting (the report of a study of splitting).

#include <cmath>
#include <fstream>
#include <iostream>
#include <string>

#include "kerf/study/splitting_report.h"
#include "sample_report.h"
#include "tests/support/splitting_sample.h"

namespace {

using namespace kerf;

StudyReport odd_report() {
  StudyReport report;
  report.title = "Test data <script>alert(1)</script> & \"odd\" 'figures'";
  const std::string scene = "a</h2><img src=\"http://127.0.0.1:9/x.png\"/>";
  for (int i = 0; i < 22; ++i) {
    std::string row =
        "stage_" + std::to_string(i) + "(option=" + std::string(static_cast<size_t>(i) * 12, 'w') + ")+<b>&amp;";
    report.results.push_back(sample_result(scene, row));
  }
  auto& r = report.results;
  r[1].trace_seconds = {0, 0, 0, 5};
  r[2].trace_seconds = {INFINITY, 1, INFINITY, 5};
  r[3].nodes_per_ray = NAN;
  r[4].triangles_per_ray = 1e12;
  r[5].triangles_per_ray = 1e-12;
  r[6].references_per_triangle = 0;
  r[7].bytes = static_cast<size_t>(-1);
  r[8].speedup = INFINITY;
  r[9].hits = 1;
  r[10].row = "\xFF\xFE control \x01 \xC2";
  for (const size_t i : {size_t{11}, size_t{12}}) {
    r[i].finished = false;
    r[i].why_not = "it is <not> \"possible\"";
  }
  StudyResult none = sample_result("nothing finished", "kd_sah");
  none.finished = false;
  r.push_back(none);
  report.sweep = {none};
  report.growth = {none, r[0]};
  report.notes = {"</ul></body></html>"};
  return report;
}

std::string splitting_page() {
  std::vector<SplittingScene> scenes{kerf::test::made_splitting_scene(),
                                     kerf::test::made_splitting_scene("a_scene_with_a_name_that_is_far_too_long")};
  scenes[1].turn = "xyz";
  for (SplittingRow& row : scenes[1].rows) row.finished = row.role != SplittingRole::balanced;
  scenes[1].skipped = {"trees for 1, 2 and 7 threads: left out as asked"};
  scenes[1].capped_references = 1.5;
  return splitting_report({"Splitting", "kerf study hall.ply --splitting", "a machine", scenes});
}

}  // namespace

int main(int argc, char** argv) {
  const std::string kind = argc > 1 ? argv[1] : "";
  StudyReport report;
  if (kind == "full") {
    report = sample_report();
  } else if (kind == "one") {
    report.results = {sample_result("one", "binned_sah")};
  } else if (kind == "odd") {
    report = odd_report();
  } else if ((kind != "empty" && kind != "splitting") || argc != 3) {
    std::cerr << "usage: write_sample full|empty|one|odd|splitting FILE\n";
    return 2;
  }
  std::ofstream file(argv[2], std::ios::binary);
  file << (kind == "splitting" ? splitting_page() : html_report(report));
  file.close();
  return file ? 0 : 1;
}
