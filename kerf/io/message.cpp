#include "kerf/io/message.h"

#include <fmt/format.h>

#include <system_error>

namespace kerf {

std::string printable(std::string_view text) {
  constexpr size_t kLimit = 40;
  std::string shown;
  for (const char c : text) {
    if (shown.size() >= kLimit) return shown + "...";
    if (' ' <= c && c <= '~') {
      shown += c;
    } else {
      shown += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    }
  }
  return shown;
}

std::string quoted(std::string_view text) { return fmt::format("'{}'", printable(text)); }

std::string system_message(int error_number) { return std::generic_category().message(error_number); }

}  // namespace kerf
