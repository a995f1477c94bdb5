#pragma once

#include <span>
#include <string>

#include "kerf/study/study.h"

namespace kerf {

/// The results as tables to read, one for each scene and kind of rays, with the paper's figures below ours.
std::string text_tables(std::span<const StudyResult> results);

/// The results as comma-separated values under a row of names, which are those of the JSON. Fields of rows that did not
/// finish are empty.
std::string csv_table(std::span<const StudyResult> results);

/// A text as a field of comma-separated values: in quotes where it needs them.
std::string csv_field(const std::string& text);

/// A line for a row below which it stands: which of its stages had no room to cut, and what gives them more. Empty
/// where all had room.
std::string room_line(std::span<const std::string> short_of_room);

/// Bytes in a unit that suits them: "512 B", "1.5 kB", "23 MB".
std::string bytes_text(size_t bytes);

}  // namespace kerf
