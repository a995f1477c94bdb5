#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kerf {

/// One option of a menu entry: its name, what it means, its default and what values it takes.
struct OptionSpec {
  std::string_view name;
  std::string_view sentence;
  double fallback = 0;
  double least = 0;
  double most = std::numeric_limits<double>::infinity();
  bool whole = false;        ///< only whole numbers
  bool above_least = false;  ///< `least` itself is not allowed
};

/// Values given to options by name; those not given have their defaults. The specs must outlive it.
class OptionValues {
 public:
  OptionValues() = default;
  explicit OptionValues(std::span<const OptionSpec> specs) : specs_(specs) {}

  /// Throws Error(invalid_option), with the nearest right word, for a name that is not there, a value out of range or
  /// not whole, or an option given twice. `owner` names the entry in the message.
  void set(std::string_view owner, std::string_view name, double value);

  bool is_set(std::string_view name) const;
  /// The value given, else the default. The name must exist.
  double operator[](std::string_view name) const;
  /// The values given, in the order of the specs.
  std::vector<std::pair<std::string_view, double>> given() const;

 private:
  std::span<const OptionSpec> specs_;
  std::vector<std::pair<std::string_view, double>> given_;
};

/// The shortest decimal text that reads back as the same double; "inf" for infinity.
std::string to_text(double value);

}  // namespace kerf
