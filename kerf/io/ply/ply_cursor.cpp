#include "kerf/io/ply/ply_cursor.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <type_traits>

#include "kerf/base/error.h"
#include "kerf/io/byte_order.h"
#include "kerf/io/message.h"

namespace kerf {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

bool has_lists(const PlyElement& element) {
  for (const PlyProperty& property : element.properties) {
    if (property.count_type) return true;
  }
  return false;
}

std::string cut_short(const PlyElement& element, uint64_t rows, const char* at_most) {
  return fmt::format("the file is cut short: the header says {} rows of element {}, {}{} {} there", element.count,
                     printable(element.name), at_most, rows, rows == 1 ? "is" : "are");
}

std::string not_whole(double value) { return fmt::format("has the value {}; expected a whole number", value); }

/// Whether the number in a text that overflows or underflows a double is small rather than large.
bool is_tiny(std::string_view text) {
  const size_t exponent = text.find_first_of("eE");
  if (exponent != text.npos) return exponent + 1 < text.size() && text[exponent + 1] == '-';
  const size_t first_digit = text.find_first_not_of("-0");
  return first_digit != text.npos && text[first_digit] == '.';
}

template <class T>
T out_of_range_value(std::string_view text) {
  double value = 0;  // stays where even a double is too short
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec == std::errc{}) return static_cast<T>(value);
  const T size = is_tiny(text) ? T{0} : std::numeric_limits<T>::infinity();
  return text.starts_with('-') ? -size : size;
}

/// A float as a whole number; the bound keeps the conversion defined and every value below it exact.
std::optional<int64_t> to_whole(double value) {
  constexpr double kLimit = 9007199254740992.0;
  if (!(std::abs(value) <= kLimit) || value != std::floor(value)) return std::nullopt;
  return static_cast<int64_t>(value);
}

}  // namespace

// --- binary ---------------------------------------------------------------------------------------------------------

PlyBinaryCursor::PlyBinaryCursor(std::span<const char> bytes, const PlyHeader& header, const std::string& name)
    : start_(bytes.data()),
      position_(start_ + header.size),
      end_(start_ + bytes.size()),
      value_(position_),
      swap_((header.format == PlyFormat::binary_little_endian) != kLittleEndianHost),
      name_(name) {}

void PlyBinaryCursor::begin(const PlyElement& element) {
  element_ = &element;
  row_ = 0;
  row_size_ = 0;
  for (const PlyProperty& property : element.properties)
    row_size_ += size_of(property.count_type.value_or(property.type));
  if (row_size_ == 0) return;
  const uint64_t room = rest().size() / row_size_;
  if (element.count > room) fail_at(end_, cut_short(element, room, has_lists(element) ? "at most " : ""));
}

const char* PlyBinaryCursor::take(size_t bytes) {
  if (static_cast<size_t>(end_ - position_) < bytes) fail_at(end_, cut_short(*element_, row_, ""));
  value_ = position_;
  position_ += bytes;
  return value_;
}

double PlyBinaryCursor::number(PlyType type) {
  const char* from = take(size_of(type));
  switch (type) {
    case PlyType::int8:
      return load_number<int8_t>(from, false);
    case PlyType::uint8:
      return load_number<uint8_t>(from, false);
    case PlyType::int16:
      return load_number<int16_t>(from, swap_);
    case PlyType::uint16:
      return load_number<uint16_t>(from, swap_);
    case PlyType::int32:
      return load_number<int32_t>(from, swap_);
    case PlyType::uint32:
      return load_number<uint32_t>(from, swap_);
    case PlyType::float32:
      return load_number<float>(from, swap_);
    case PlyType::float64:
      break;
  }
  return load_number<double>(from, swap_);
}

int64_t PlyBinaryCursor::whole(PlyType type) {
  // A double holds every integer of PLY exactly, so one switch serves both.
  const double value = number(type);
  const auto integer = to_whole(value);
  if (!integer) fail(not_whole(value));
  return *integer;
}

double PlyBinaryCursor::real(const PlyProperty& property) { return number(property.type); }

int64_t PlyBinaryCursor::integer(const PlyProperty& property) { return whole(property.type); }

uint64_t PlyBinaryCursor::list_count(const PlyProperty& property) {
  const int64_t count = whole(*property.count_type);
  if (count < 0) fail(fmt::format("has a list {} of {} values", printable(property.name), count));
  const uint64_t room = rest().size() / size_of(property.type);
  if (static_cast<uint64_t>(count) > room) {
    fail(fmt::format("has a list {} of {} values, but the file ends after {} more; {} of {} rows are there",
                     printable(property.name), count, room, row_, element_->count));
  }
  return static_cast<uint64_t>(count);
}

void PlyBinaryCursor::skip(const PlyProperty& property) {
  const uint64_t values = property.count_type ? list_count(property) : 1;
  take(values * size_of(property.type));
}

bool PlyBinaryCursor::skip_rows() {
  if (has_lists(*element_)) return false;
  take(element_->count * row_size_);  // begin() has seen that this is there
  return true;
}

uint64_t PlyBinaryCursor::most_triangle_rows(const PlyProperty& list) const {
  return rest().size() / (row_size_ + 3 * size_of(list.type));
}

void PlyBinaryCursor::fail(const std::string& sentence) const {
  fail_at(value_, fmt::format("{} {} {}", printable(element_->name), row_, sentence));
}

void PlyBinaryCursor::fail_at(const char* at, const std::string& sentence) const {
  throw Error(ErrorCode::file, fmt::format("{}, byte {}", name_, at - start_), sentence);
}

// --- ascii ----------------------------------------------------------------------------------------------------------

PlyAsciiCursor::PlyAsciiCursor(std::span<const char> bytes, const PlyHeader& header, const std::string& name)
    : position_(bytes.data() + header.size), end_(bytes.data() + bytes.size()), line_(header.lines + 1), name_(name) {}

void PlyAsciiCursor::begin(const PlyElement& element) {
  element_ = &element;
  row_ = 0;
  row_size_ = 2 * element.properties.size();  // a digit and what parts it from the next
  if (row_size_ == 0) return;
  const uint64_t room = (static_cast<size_t>(end_ - position_) + 1) / row_size_;  // the last may have no line end
  if (element.count > room) fail_here(cut_short(element, room, "at most "));
}

void PlyAsciiCursor::begin_row(uint64_t row) {
  row_ = row;
  while (position_ != end_ && (is_blank(*position_) || *position_ == '\n')) {
    if (*position_ == '\n') ++line_;
    ++position_;
  }
  if (position_ == end_) fail_here(cut_short(*element_, row_, ""));
}

void PlyAsciiCursor::end_row() {
  while (position_ != end_ && is_blank(*position_)) ++position_;
  if (position_ == end_ || *position_ == '\n') return;
  const char* more = position_;
  while (position_ != end_ && *position_ != '\n' && !is_blank(*position_)) ++position_;
  fail(fmt::format("has more values on its line than the header says, from {} on", quoted({more, position_})));
}

std::string_view PlyAsciiCursor::token(const PlyProperty& property) {
  while (position_ != end_ && is_blank(*position_)) ++position_;
  const char* begin = position_;
  while (position_ != end_ && *position_ != '\n' && !is_blank(*position_)) ++position_;
  if (position_ != begin) return {begin, position_};
  if (position_ == end_) fail_here(cut_short(*element_, row_, ""));
  fail(fmt::format("has too few values: its line ends where {} was expected", printable(property.name)));
}

template <class T>
T PlyAsciiCursor::parse(std::string_view text, const PlyProperty& property) const {
  const char* expected = std::is_integral_v<T> ? "a whole number" : "a number";
  std::string_view digits = text;
  // from_chars knows no plus sign; "+-1" stays an error.
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::invalid_argument || end != digits.data() + digits.size()) {
    fail(fmt::format("has {} where {} was expected ({})", quoted(text), expected, printable(property.name)));
  }
  if (error == std::errc{}) return value;
  if constexpr (std::is_floating_point_v<T>) return out_of_range_value<T>(digits);
  fail(fmt::format("has the number {}, which is out of range ({})", quoted(text), printable(property.name)));
}

double PlyAsciiCursor::number(PlyType type, const PlyProperty& property) {
  const std::string_view text = token(property);
  switch (type) {
    case PlyType::float32:
      return parse<float>(text, property);  // rounded once
    case PlyType::float64:
      return parse<double>(text, property);
    default:
      return static_cast<double>(parse<int64_t>(text, property));
  }
}

int64_t PlyAsciiCursor::whole(PlyType type, const PlyProperty& property) {
  if (type != PlyType::float32 && type != PlyType::float64) return parse<int64_t>(token(property), property);
  const double value = parse<double>(token(property), property);
  const auto integer = to_whole(value);
  if (!integer) fail(not_whole(value));
  return *integer;
}

double PlyAsciiCursor::real(const PlyProperty& property) { return number(property.type, property); }

int64_t PlyAsciiCursor::integer(const PlyProperty& property) { return whole(property.type, property); }

uint64_t PlyAsciiCursor::list_count(const PlyProperty& property) {
  const int64_t count = whole(*property.count_type, property);
  if (count < 0) fail(fmt::format("has a list {} of {} values", printable(property.name), count));
  return static_cast<uint64_t>(count);  // the line ends long before an absurd one does
}

void PlyAsciiCursor::skip(const PlyProperty& property) {
  if (!property.count_type) {
    number(property.type, property);  // read all the same: text between numbers is a sign of a wrong header
    return;
  }
  const uint64_t count = list_count(property);
  for (uint64_t i = 0; i < count; ++i) number(property.type, property);
}

uint64_t PlyAsciiCursor::most_triangle_rows(const PlyProperty&) const {
  return (static_cast<size_t>(end_ - position_) + 1) / (row_size_ + 6);
}

void PlyAsciiCursor::fail(const std::string& sentence) const {
  fail_here(fmt::format("{} {} {}", printable(element_->name), row_, sentence));
}

void PlyAsciiCursor::fail_here(const std::string& sentence) const {
  throw Error(ErrorCode::file, fmt::format("{}:{}", name_, line_), sentence);
}

}  // namespace kerf
