#include "kerf/base/nearest_word.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "kerf/base/letter_case.h"

namespace kerf {
namespace {

/// The Damerau-Levenshtein distance in its restricted form, where no letter takes part in two changes (optimal string
/// alignment): enough for typing errors, and three rows of the table are all it needs.
size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<size_t> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) above[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t changed = above[j - 1] + (to_lower(a[i - 1]) == to_lower(b[j - 1]) ? 0 : 1);
      row[j] = std::min({changed, above[j] + 1, row[j - 1] + 1});
      const bool swapped =
          i > 1 && j > 1 && to_lower(a[i - 1]) == to_lower(b[j - 2]) && to_lower(a[i - 2]) == to_lower(b[j - 1]);
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before.swap(above);
    above.swap(row);
  }
  return above[b.size()];
}

}  // namespace

std::string_view nearest_word(std::string_view word, std::span<const std::string_view> menu) {
  if (word.empty()) return {};
  const size_t limit = word.size() / 3 + 1;
  size_t nearest = limit + 1;
  std::string_view found;
  for (const std::string_view candidate : menu) {
    const size_t longer = std::max(word.size(), candidate.size());
    // The difference in length alone is a lower bound; a word of any length in a file then costs next to nothing.
    if (longer - std::min(word.size(), candidate.size()) > limit) continue;
    const size_t distance = edit_distance(word, candidate);
    if (distance >= nearest || distance >= longer) continue;  // with no letter in common nothing is near
    nearest = distance;
    found = candidate;
  }
  return found;
}

std::string suggestion(std::string_view word, std::span<const std::string_view> menu) {
  std::string sentence;
  if (const std::string_view nearest = nearest_word(word, menu); !nearest.empty()) {
    return sentence.append("; did you mean '").append(nearest).append("'?");
  }
  sentence = "; expected ";
  for (size_t i = 0; i < menu.size(); ++i) {
    if (i > 0) sentence += i + 1 < menu.size() ? ", " : " or ";
    sentence += menu[i];
  }
  return sentence;
}

}  // namespace kerf
