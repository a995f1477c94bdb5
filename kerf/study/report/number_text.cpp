#include "kerf/study/report/number_text.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <span>

namespace kerf::report {
namespace {

constexpr Unit kTimeUnits[] = {{"s", 1}, {"ms", 1e-3}, {"\xC2\xB5s", 1e-6}, {"ns", 1e-9}};
constexpr Unit kByteUnits[] = {{"GB", 1e9}, {"MB", 1e6}, {"kB", 1e3}, {"B", 1}};
constexpr double kLeastPlain = 1e-4, kMostPlain = 1e10;

/// Puts a comma between groups of three digits before the point.
std::string grouped(const std::string& digits) {
  const size_t point = std::min(digits.find('.'), digits.size());
  std::string out;
  for (size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && i < point && (point - i) % 3 == 0) out += ',';
    out += digits[i];
  }
  return out;
}

/// "2.5·10⁻⁷".
std::string with_power(double magnitude) {
  constexpr std::string_view kDigits[] = {"\xE2\x81\xB0", "\xC2\xB9",     "\xC2\xB2",     "\xC2\xB3",
                                          "\xE2\x81\xB4", "\xE2\x81\xB5", "\xE2\x81\xB6", "\xE2\x81\xB7",
                                          "\xE2\x81\xB8", "\xE2\x81\xB9"};
  const std::string text = fmt::format("{:.2e}", magnitude);
  const size_t e = text.find('e');
  const int power = std::atoi(text.c_str() + e + 1);
  std::string out = text.substr(0, e) + "\xC2\xB7" + "10";
  if (power < 0) out += "\xE2\x81\xBB";
  for (const char digit : std::to_string(std::abs(power))) out += kDigits[digit - '0'];
  return out;
}

std::string magnitude_text(double magnitude) {
  if (std::isinf(magnitude)) return "\xE2\x88\x9E";
  if (magnitude == 0) return "0";
  if (magnitude < kLeastPlain || magnitude >= kMostPlain) return with_power(magnitude);
  // As it is rounded to three digits: 9.999 is 10.0, not 10.00.
  const double rounded = std::strtod(fmt::format("{:.2e}", magnitude).c_str(), nullptr);
  const int before_point = static_cast<int>(std::floor(std::log10(rounded))) + 1;
  return grouped(fmt::format("{:.{}f}", magnitude, std::max(0, 3 - before_point)));
}

Unit unit_of(double value, std::span<const Unit> units, Unit otherwise) {
  if (!(value > 0) || std::isinf(value)) return otherwise;
  for (const Unit& unit : units) {
    if (value >= unit.size) return unit;
  }
  return units.back();
}

std::string with_unit(const std::string& number, std::string_view unit) {
  return fmt::format("{}\xC2\xA0{}", number, unit);  // a space at which no line ends
}

}  // namespace

std::string number_text(double value) {
  if (std::isnan(value)) return "NaN";
  return (value < 0 ? "\xE2\x88\x92" : "") + magnitude_text(std::abs(value));
}

std::string count_text(uint64_t value) { return grouped(std::to_string(value)); }

std::string chosen_text(double value) {
  const double size = std::abs(value);
  if (!(size >= kLeastPlain && size < kMostPlain)) return number_text(value);
  const std::string digits = fmt::format("{}", size);
  return (value < 0 ? "\xE2\x88\x92" : "") + (digits.find('e') == std::string::npos ? grouped(digits) : digits);
}

Unit time_unit(double seconds) { return unit_of(seconds, kTimeUnits, {"s", 1}); }

Unit byte_unit(double bytes) { return unit_of(bytes, kByteUnits, {"B", 1}); }

std::string seconds_text(double seconds) {
  const Unit unit = time_unit(seconds);
  return with_unit(number_text(seconds / unit.size), unit.name);
}

std::string bytes_text(double bytes) {
  const Unit unit = byte_unit(bytes);
  return with_unit(number_text(bytes / unit.size), unit.name);
}

std::string number_tick(double value) {
  const double size = std::abs(value);
  if (size >= 1e15 || (size > 0 && size < kLeastPlain)) return number_text(value);
  for (const auto& [name, unit] : {Unit{"G", 1e9}, Unit{"M", 1e6}, Unit{"k", 1e3}}) {
    if (size >= unit) return fmt::format("{:.6g}{}", value / unit, name);
  }
  return fmt::format("{:.6g}", value);
}

std::string seconds_tick(double seconds) {
  const Unit unit = time_unit(seconds);
  if (seconds == 0) return "0";
  const bool plain = seconds >= 1e3 && seconds < 1e6;  // "1k s" is nobody's
  return with_unit(plain ? grouped(fmt::format("{:.0f}", seconds)) : number_tick(seconds / unit.size), unit.name);
}

std::string bytes_tick(double bytes) {
  const Unit unit = byte_unit(bytes);
  return bytes == 0 ? "0" : with_unit(number_tick(bytes / unit.size), unit.name);
}

std::string script_number(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value < 0 ? "-Infinity" : "Infinity";
  return fmt::format("{}", value);
}

std::string place_text(double value) {
  const double tenths = std::round(value * 10);
  return fmt::format("{:.6g}", tenths == 0 ? 0 : tenths / 10);
}

}  // namespace kerf::report
