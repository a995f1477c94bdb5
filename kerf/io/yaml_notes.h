#pragma once

#include <cstddef>
#include <string>
#include <unordered_map>
#include <vector>

namespace kerf {

/// Notes about a scene file, equal ones collected: "a light does not use 'albedo' (room.yaml:12:30 and 2 more)".
class YamlNotes {
 public:
  void add(const std::string& sentence, const std::string& place);

  /// In the order in which each was first met.
  std::vector<std::string> sentences() const;

 private:
  struct Note {
    std::string sentence, first_place;
    size_t more = 0;
  };
  std::vector<Note> notes_;
  std::unordered_map<std::string, size_t> numbers_;  // of notes_, by sentence
};

}  // namespace kerf
