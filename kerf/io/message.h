#pragma once

#include <span>
#include <string>
#include <string_view>

namespace kerf {

/// Text out of a file as it may stand in a message: all but printable ASCII as \xNN, at most some 40 characters.
std::string printable(std::string_view text);

/// printable() between single quotes.
std::string quoted(std::string_view text);

/// The end of a sentence about a word that is not in the menu: "; did you mean 'float'?", or where nothing is near
/// "; expected char, short or int".
std::string suggestion(std::string_view word, std::span<const std::string_view> menu);

/// What the system's error number says, such as "No space left on device".
std::string system_message(int error_number);

}  // namespace kerf
