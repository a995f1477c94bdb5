#include "kerf/base/options.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>

#include "kerf/base/error.h"
#include "kerf/base/nearest_word.h"

namespace kerf {
namespace {

const OptionSpec* find(std::span<const OptionSpec> specs, std::string_view name) {
  const auto found =
      std::find_if(specs.begin(), specs.end(), [&](const OptionSpec& spec) { return spec.name == name; });
  return found == specs.end() ? nullptr : &*found;
}

std::string unknown_option(std::span<const OptionSpec> specs, std::string_view name) {
  const std::string sentence = "unknown option '" + std::string(name) + "'";
  if (specs.empty()) return sentence + "; it takes none";
  std::vector<std::string_view> names;
  for (const OptionSpec& spec : specs) names.push_back(spec.name);
  return sentence + suggestion(name, names);
}

std::string range_text(const OptionSpec& spec) {
  if (!spec.words.empty()) {
    std::string text;
    for (const std::string_view word : spec.words) text += (text.empty() ? "" : " or ") + std::string(word);
    return text;
  }
  std::string text = spec.whole ? "a whole number " : "";
  text += (spec.above_least ? "above " : "at least ") + to_text(spec.least);
  if (!std::isinf(spec.most)) text += " and at most " + to_text(spec.most);
  return text;
}

/// The number that a text means for an option; throws Error(invalid_option).
double parse_value(std::string_view owner, const OptionSpec& spec, std::string_view text) {
  const std::string place(owner);
  if (!spec.words.empty()) {
    const auto found = std::find(spec.words.begin(), spec.words.end(), text);
    if (found != spec.words.end()) return static_cast<double>(found - spec.words.begin());
    throw Error(ErrorCode::invalid_option, place,
                std::string(spec.name) + "=" + std::string(text) + " is not known" + suggestion(text, spec.words));
  }
  if (spec.may_be_auto && text == "auto") return kAutomatic;
  double value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status == std::errc::result_out_of_range) {
    throw Error(ErrorCode::invalid_option, place, std::string(spec.name) + ": the value is out of range");
  }
  if (status != std::errc() || end != text.data() + text.size() || std::isnan(value)) {
    throw Error(ErrorCode::invalid_option, place,
                std::string(spec.name) + ": expected a number" + (spec.may_be_auto ? " or auto" : ""));
  }
  return value;
}

}  // namespace

std::string OptionSpec::text_of(double value) const {
  if (may_be_auto && is_automatic(value)) return "auto";
  return words.empty() ? to_text(value) : std::string(words[static_cast<size_t>(value)]);
}

void OptionValues::set(std::string_view owner, std::string_view name, std::string_view value) {
  const OptionSpec* spec = find(specs_, name);
  // An unknown name is refused below, whatever its value.
  set(owner, name, spec != nullptr ? parse_value(owner, *spec, value) : 0);
}

void OptionValues::set(std::string_view owner, std::string_view name, double value) {
  const OptionSpec* spec = find(specs_, name);
  if (spec == nullptr) throw Error(ErrorCode::invalid_option, std::string(owner), unknown_option(specs_, name));
  if (is_set(name))
    throw Error(ErrorCode::invalid_option, std::string(owner), "option '" + std::string(name) + "' is given twice");
  if (spec->may_be_auto && is_automatic(value)) {
    given_.emplace_back(spec->name, value);
    return;
  }
  const bool in_range = value <= spec->most && (spec->above_least ? value > spec->least : value >= spec->least);
  if (!in_range || (spec->whole && value != std::floor(value))) {
    throw Error(ErrorCode::invalid_option, std::string(owner),
                std::string(name) + "=" + to_text(value) + " is out of range; it must be " + range_text(*spec));
  }
  given_.emplace_back(spec->name, value);
}

bool OptionValues::is_set(std::string_view name) const {
  return std::any_of(given_.begin(), given_.end(), [&](const auto& entry) { return entry.first == name; });
}

double OptionValues::operator[](std::string_view name) const {
  for (const auto& [given, value] : given_) {
    if (given == name) return value;
  }
  const OptionSpec* spec = find(specs_, name);
  assert(spec != nullptr);
  return spec->fallback;
}

std::vector<std::pair<std::string_view, std::string>> OptionValues::given() const {
  std::vector<std::pair<std::string_view, std::string>> ordered;
  for (const OptionSpec& spec : specs_) {
    if (is_set(spec.name)) ordered.emplace_back(spec.name, spec.text_of((*this)[spec.name]));
  }
  return ordered;
}

std::string to_text(double value) {
  char text[64];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

}  // namespace kerf
