#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kerf {

/// One option of a menu entry: its name, what it means, its default and what values it takes.
///
///     {"bins", "slices along each axis", 32, 2, 256, true}
///     {"mailbox", "whether ...", 1, kOffOn}
struct OptionSpec {
  std::string_view name;
  std::string_view sentence;
  double fallback = 0;
  double least = 0;
  double most = std::numeric_limits<double>::infinity();
  bool whole = false;        ///< only whole numbers
  bool above_least = false;  ///< `least` itself is not allowed
  std::span<const std::string_view>
      words;                 ///< not empty: the value is written as one of these; its number is 0, 1, ...
  bool may_be_auto = false;  ///< takes the word "auto" too; see kAutomatic

  constexpr OptionSpec() = default;
  constexpr OptionSpec(std::string_view n, std::string_view s, double f, double from,
                       double to = std::numeric_limits<double>::infinity(), bool only_whole = false,
                       bool not_least = false)
      : name(n), sentence(s), fallback(f), least(from), most(to), whole(only_whole), above_least(not_least) {}
  constexpr OptionSpec(std::string_view n, std::string_view s, double f, std::span<const std::string_view> w)
      : name(n), sentence(s), fallback(f), most(static_cast<double>(w.size()) - 1), whole(true), words(w) {}

  /// A value as it is written: a word, or to_text().
  std::string text_of(double value) const;
};

/// The number of the word "auto": not a number, to be asked for with is_automatic().
inline constexpr double kAutomatic = std::numeric_limits<double>::quiet_NaN();
constexpr bool is_automatic(double value) { return value != value; }

/// An option that takes the word "auto" beside numbers.
constexpr OptionSpec with_auto(OptionSpec spec) {
  spec.may_be_auto = true;
  return spec;
}

/// The words of a switch.
inline constexpr std::string_view kOffOn[] = {"off", "on"};

/// Values given to options by name; those not given have their defaults. The specs must outlive it.
class OptionValues {
 public:
  OptionValues() = default;
  explicit OptionValues(std::span<const OptionSpec> specs) : specs_(specs) {}

  /// Throws Error(invalid_option), with the nearest right word, for a name that is not there, a value out of range or
  /// not whole, or an option given twice. `owner` names the entry in the message.
  void set(std::string_view owner, std::string_view name, double value);
  /// The same for a value as it is written, a number or a word.
  void set(std::string_view owner, std::string_view name, std::string_view value);

  bool is_set(std::string_view name) const;
  /// The value given, else the default. The name must exist.
  double operator[](std::string_view name) const;
  /// The value of an option that has words is not the first.
  bool is_on(std::string_view name) const { return (*this)[name] != 0; }
  /// The values given as they are written, in the order of the specs.
  std::vector<std::pair<std::string_view, std::string>> given() const;

 private:
  std::span<const OptionSpec> specs_;
  std::vector<std::pair<std::string_view, double>> given_;
};

/// The shortest decimal text that reads back as the same double; "inf" for infinity.
std::string to_text(double value);

}  // namespace kerf
