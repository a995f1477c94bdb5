#include "kerf/io/notes.h"

#include <fmt/format.h>

#include <algorithm>

#include "kerf/io/message.h"

namespace kerf {

void Notes::add(const std::string& sentence, const std::string& subject) {
  const auto [found, is_new] = numbers_.try_emplace(sentence, notes_.size());
  if (is_new) notes_.push_back({sentence, subject});
  ++notes_[found->second].count;
}

std::vector<std::string> Notes::sentences() const {
  std::vector<std::string> all;
  for (const Note& note : notes_) {
    if (note.subject.empty()) {
      all.push_back(note.sentence);
    } else if (note.count == 1) {
      all.push_back(fmt::format("{} ({})", note.sentence, note.subject));
    } else {
      all.push_back(fmt::format("{} ({} and {} more)", note.sentence, note.subject, note.count - 1));
    }
  }
  return all;
}

std::string sentence_of(const Error& error) {
  const std::string_view what = error.what();
  const size_t prefix = error.place().empty() ? 0 : error.place().size() + 2;  // "place: "
  return std::string(what.substr(std::min(prefix, what.size())));
}

std::string first_line(std::string_view text) {
  constexpr size_t kMost = 200;  // it may repeat what the file has
  std::string shown;
  for (const char c : text.substr(0, std::min(text.find('\n'), kMost))) shown += printable({&c, 1});
  return shown;
}

}  // namespace kerf
