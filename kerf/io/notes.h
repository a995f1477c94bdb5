#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "kerf/base/error.h"

namespace kerf {

/// What of a file cannot be shown, gathered so that a thousand materials with one fault give one sentence.
class Notes {
 public:
  /// `sentence` is true of `subject`, such as "materials[3]"; an empty one says it of the whole file.
  void add(const std::string& sentence, const std::string& subject = {});

  /// Each sentence once, in the order in which they came, with its first subject and how many more there are.
  std::vector<std::string> sentences() const;

 private:
  struct Note {
    std::string sentence, subject;
    size_t count = 0;
  };
  std::vector<Note> notes_;
  std::unordered_map<std::string, size_t> numbers_;  // of notes, by sentence
};

/// What an Error says, without its place.
std::string sentence_of(const Error& error);

/// The first line of what another library says, at most 200 characters, printable.
std::string first_line(std::string_view text);

}  // namespace kerf
