#include "kerf/io/yaml_notes.h"

#include <fmt/format.h>

namespace kerf {

void YamlNotes::add(const std::string& sentence, const std::string& place) {
  const auto [found, is_new] = numbers_.emplace(sentence, notes_.size());
  if (is_new) {
    notes_.push_back({sentence, place});
  } else {
    ++notes_[found->second].more;
  }
}

std::vector<std::string> YamlNotes::sentences() const {
  std::vector<std::string> all;
  for (const Note& note : notes_) {
    const std::string more = note.more > 0 ? fmt::format(" and {} more", note.more) : "";
    all.push_back(fmt::format("{} ({}{})", note.sentence, note.first_place, more));
  }
  return all;
}

}  // namespace kerf
