#pragma once

#include <string>
#include <string_view>

namespace kerf {

/// Text out of a file as it may stand in a message: all but printable ASCII as \xNN, at most some 40 characters.
std::string printable(std::string_view text);

/// printable() between single quotes.
std::string quoted(std::string_view text);

/// What the system's error number says, such as "No space left on device".
std::string system_message(int error_number);

}  // namespace kerf
