#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace kerf {

/// The small letter of an ASCII capital; all else as it is, whatever the locale.
constexpr char to_lower(char c) { return 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// A text in small letters.
inline std::string lower_case(std::string text) {
  for (char& c : text) c = to_lower(c);
  return text;
}

/// Whether two texts differ in nothing but capitals.
inline bool equals_ignoring_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return to_lower(x) == to_lower(y); });
}

}  // namespace kerf
