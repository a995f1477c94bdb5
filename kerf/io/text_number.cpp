#include "kerf/io/text_number.h"

#include <bit>
#include <charconv>
#include <cstdint>
#include <limits>
#include <system_error>

namespace kerf {
namespace {

constexpr int64_t kMostExponent = 1000000;  // more than any file has digits for; keeps sums from overflowing

bool is_digit(char c) { return '0' <= c && c <= '9'; }

/// The parts of a number as they stand in the text: mantissa * 10^exponent.
struct Decimal {
  const char* end = nullptr;
  uint64_t mantissa = 0;  // has wrapped around where there are more than 19 digits
  int64_t digits = 0;
  int64_t exponent = 0;
};

/// Reads "e-5" and its like; leaves `p` where it is if no digit follows, as from_chars does.
const char* read_exponent(const char* p, const char* end, int64_t& exponent) {
  if (p == end || (*p != 'e' && *p != 'E')) return p;
  const char* q = p + 1;
  const bool negative = q != end && *q == '-';
  if (q != end && (*q == '-' || *q == '+')) ++q;
  if (q == end || !is_digit(*q)) return p;
  int64_t value = 0;
  for (; q != end && is_digit(*q); ++q) {
    if (value < kMostExponent) value = value * 10 + (*q - '0');
  }
  exponent += negative ? -value : value;
  return q;
}

/// Reads the digits, point and exponent that stand behind the sign; no digits where there are none.
Decimal read_decimal(const char* p, const char* end) {
  Decimal decimal;
  const char* integer = p;
  for (; p != end && is_digit(*p); ++p) decimal.mantissa = decimal.mantissa * 10 + static_cast<uint64_t>(*p - '0');
  decimal.digits = p - integer;
  if (p != end && *p == '.') {
    const char* fraction = ++p;
    for (; p != end && is_digit(*p); ++p) decimal.mantissa = decimal.mantissa * 10 + static_cast<uint64_t>(*p - '0');
    decimal.exponent = fraction - p;
    decimal.digits += p - fraction;
  }
  decimal.end = decimal.digits == 0 ? p : read_exponent(p, end, decimal.exponent);
  return decimal;
}

/// The exact powers of ten of a double.
constexpr double kPowers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                              1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/// What nearly all numbers of files are: few digits, a small exponent. One exactly rounded operation of doubles gives
/// the nearest double, and that rounds to the nearest float unless it lies in the middle between two, where the first
/// rounding may have been what put it there. All such numbers are zero or in the range of normal floats. False where
/// this way is not open.
bool convert_fast(const Decimal& decimal, float& value) {
  constexpr int64_t kMostPower = 22;
  if (decimal.digits > 19 || decimal.mantissa >> 53 != 0) return false;
  if (decimal.exponent < -kMostPower || decimal.exponent > kMostPower) return false;
  const auto mantissa = static_cast<double>(decimal.mantissa);
  const double wide =
      decimal.exponent < 0 ? mantissa / kPowers[-decimal.exponent] : mantissa * kPowers[decimal.exponent];
  constexpr uint64_t kDropped = (uint64_t{1} << 29) - 1;  // the bits that a double has more than a float
  constexpr uint64_t kMiddle = uint64_t{1} << 28;
  if ((std::bit_cast<uint64_t>(wide) & kDropped) == kMiddle) return false;
  value = static_cast<float>(wide);
  return true;
}

/// Whether a number that overflows or underflows a float is small rather than large.
bool is_tiny(const char* p, const char* end) {
  int64_t before_point = 0, zeros = 0;  // digits from the first that is no zero; zeros behind the point before it
  bool has_point = false, has_digit = false;
  for (; p != end && (is_digit(*p) || *p == '.'); ++p) {
    if (*p == '.') {
      has_point = true;
    } else if (*p != '0' || has_digit) {
      has_digit = true;
      if (!has_point) ++before_point;
    } else if (has_point) {
      ++zeros;
    }
  }
  int64_t magnitude = before_point - zeros;
  read_exponent(p, end, magnitude);
  return magnitude < 0;
}

const char* convert_any(const char* p, const char* end, float& value) {
  float magnitude = 0;
  const auto [after, error] = std::from_chars(p, end, magnitude);
  if (error == std::errc::invalid_argument) return nullptr;
  if (error == std::errc::result_out_of_range) {
    magnitude = is_tiny(p, after) ? 0.0F : std::numeric_limits<float>::infinity();
  }
  value = magnitude;
  return after;
}

}  // namespace

const char* parse_float(const char* begin, const char* end, float& value) {
  const char* p = begin;
  const bool negative = p != end && *p == '-';
  if (p != end && (*p == '-' || *p == '+')) ++p;
  if (p != end && (*p == '-' || *p == '+')) return nullptr;  // from_chars would take a second sign
  const Decimal decimal = read_decimal(p, end);
  const char* after = decimal.end;
  if (decimal.digits == 0 || !convert_fast(decimal, value)) after = convert_any(p, end, value);
  if (after != nullptr && negative) value = -value;
  return after;
}

}  // namespace kerf
