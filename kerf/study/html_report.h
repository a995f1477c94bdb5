#pragma once

#include <string>
#include <vector>

#include "kerf/io/image.h"
#include "kerf/study/study.h"

namespace kerf {

struct ReportPicture {
  std::string scene;  ///< the section that it stands in
  std::string caption;
  Image image;  ///< as displayed, values in [0, 1], 1 or 3 channels
};

/// What a report shows.
struct StudyReport {
  std::string title;
  std::string command;               ///< that made it
  std::string machine;               ///< processor, threads, date: a line
  std::vector<StudyResult> results;  ///< a table and charts for each scene and kind of rays
  std::vector<StudyResult> sweep;    ///< curves over R: results of one pipeline with different sa_max
  std::vector<StudyResult> growth;   ///< curves over the number of triangles: scenes of one family
  std::vector<ReportPicture> pictures;
  std::vector<std::string> notes;  ///< sentences
};

/// The report as one HTML page that needs nothing else: charts are inline SVG, pictures are PNG in data URIs. All text
/// is escaped, and the page is well-formed XML besides. The same report gives the same bytes. Throws Error
/// (invalid_argument) as encode_png() does for a picture that is none.
std::string html_report(const StudyReport& report);

}  // namespace kerf
