#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace kerf::report {

/// A number to be read: three significant digits, all digits before the point, groups of three, no exponent between
/// 0.0001 and ten thousand millions; "∞", "−∞" or "NaN".
std::string number_text(double value);

/// "1,234,567".
std::string count_text(uint64_t value);

/// A number that somebody has chosen, as it was written: "30", "0.5", "1,000,000".
std::string chosen_text(double value);

/// A unit, and what one of it is in seconds or bytes.
struct Unit {
  std::string_view name;
  double size = 1;
};

/// The largest of ns, µs, ms and s of which `seconds` is at least one; s for what is no time.
Unit time_unit(double seconds);

/// The largest of B, kB, MB and GB (powers of a thousand) of which `bytes` are at least one.
Unit byte_unit(double bytes);

/// A number with its own unit: "1.98 s", "27.1 MB".
std::string seconds_text(double seconds);
std::string bytes_text(double bytes);

// The same on an axis: as short as can be, "50 ms", "2k".
std::string number_tick(double value);
std::string seconds_tick(double seconds);
std::string bytes_tick(double bytes);

/// A number for a script: all of its digits, "Infinity", "-Infinity" or "NaN".
std::string script_number(double value);

/// A coordinate in a picture: to a tenth.
std::string place_text(double value);

}  // namespace kerf::report
