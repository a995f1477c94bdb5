#pragma once

#include <span>
#include <string>
#include <string_view>

namespace kerf {

/// The word of the menu that was most likely meant by `word`: the fewest letters changed, left out, added or swapped
/// with their neighbour, whatever the case; the first of equals. Empty where nothing is near, which is more than a
/// third of the letters and one more.
std::string_view nearest_word(std::string_view word, std::span<const std::string_view> menu);

/// The end of a sentence about a word that is not in the menu: "; did you mean 'float'?", or where nothing is near
/// "; expected char, short or int".
std::string suggestion(std::string_view word, std::span<const std::string_view> menu);

}  // namespace kerf
