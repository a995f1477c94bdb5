#include "kerf/io/message.h"

#include <fmt/format.h>

#include <system_error>

#include "kerf/base/nearest_word.h"

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

std::string suggestion(std::string_view word, std::span<const std::string_view> menu) {
  const std::string_view nearest = nearest_word(word, menu);
  if (!nearest.empty()) return fmt::format("; did you mean {}?", quoted(nearest));
  std::string sentence = "; expected ";
  for (size_t i = 0; i < menu.size(); ++i) {
    if (i > 0) sentence += i + 1 < menu.size() ? ", " : " or ";
    sentence += menu[i];
  }
  return sentence;
}

std::string system_message(int error_number) { return std::generic_category().message(error_number); }

}  // namespace kerf
