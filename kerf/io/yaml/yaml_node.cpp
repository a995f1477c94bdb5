#include "kerf/io/yaml/yaml_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <utility>

#include "kerf/base/error.h"
#include "kerf/base/nearest_word.h"
#include "kerf/io/message.h"

namespace kerf {
namespace {

constexpr uint32_t kAbsent = std::numeric_limits<uint32_t>::max();

/// A decimal number as YAML 1.2 writes it; nothing for any other text. Out of range of a double: infinite.
std::optional<double> parse_number(std::string_view text) {
  const bool has_sign = text.starts_with('+') || text.starts_with('-');
  const std::string_view digits = text.substr(has_sign ? 1 : 0);
  // from_chars() would take "inf" and "nan" too.
  if (digits.empty() || !(digits[0] == '.' || ('0' <= digits[0] && digits[0] <= '9'))) return std::nullopt;
  double size = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), size);
  if (end != digits.data() + digits.size() || error == std::errc::invalid_argument) return std::nullopt;
  if (error != std::errc{}) size = std::numeric_limits<double>::infinity();
  return text[0] == '-' ? -size : size;
}

bool is_one_of(std::string_view text, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), text) != words.end();
}

std::string sentence_of(const YamlRange& range) {
  const bool has_most = range.most < kMaxCoordinate;
  if (!range.is_open) {
    return has_most ? fmt::format("must be from {} to {}", range.least, range.most)
                    : fmt::format("must be at least {}", range.least);
  }
  return fmt::format("must be greater than {}", range.least) +
         (has_most ? fmt::format(" and less than {}", range.most) : "");
}

bool holds(const YamlRange& range, double x) {
  if (!range.is_open) return range.least <= x && x <= range.most;
  return range.least < x && (x < range.most || range.most == kMaxCoordinate);
}

}  // namespace

size_t YamlNode::size() const {
  switch (kind()) {
    case YamlKind::sequence:
      return node().count;
    case YamlKind::map:
      return node().count / 2;
    default:
      return 0;
  }
}

bool YamlNode::is_before(const YamlNode& other) const {
  return use_.line != other.use_.line ? use_.line < other.use_.line : use_.column < other.use_.column;
}

std::string YamlNode::place() const { return fmt::format("{}:{}:{}", tree_->name, use_.line, use_.column); }

std::string YamlNode::description() const {
  switch (kind()) {
    case YamlKind::scalar:
      return (is_quoted() ? "the quoted text " : "") + quoted(text());
    case YamlKind::sequence:
      return fmt::format("a list of {}", size());
    case YamlKind::map:
      return "a map";
    default:
      return "nothing";
  }
}

void YamlNode::fail(const std::string& sentence) const { throw Error(ErrorCode::file, place(), sentence); }

void YamlField::fail(const std::string& sentence) const { node_.fail(fmt::format("{}: {}", key_, sentence)); }

void YamlField::fail_type(std::string_view what) const {
  fail(fmt::format("expected {}, found {}", what, node_.description()));
}

double YamlField::number(const YamlRange& range) const {
  if (node_.kind() != YamlKind::scalar || node_.is_quoted()) fail_type("a number");
  const std::string_view text = node_.text();
  if (is_one_of(text, {".inf", ".Inf", ".INF", "+.inf", "-.inf", ".nan", ".NaN", ".NAN"})) {
    fail(fmt::format("must be finite, found {}", node_.description()));
  }
  const std::optional<double> x = parse_number(text);
  if (!x) fail_type("a number");
  if (!(-kMaxCoordinate <= *x && *x <= kMaxCoordinate)) {
    fail(fmt::format("a number's size must be at most 2^120 (1.3e36) and not too small for a double, found {}",
                     node_.description()));
  }
  if (!holds(range, *x)) fail(fmt::format("{}, found {}", sentence_of(range), printable(text)));
  return *x;
}

float YamlField::single(const YamlRange& range) const {
  const auto x = static_cast<float>(number(range));
  if (!holds(range, x)) fail(fmt::format("{} is 0 in single precision", printable(node_.text())));
  return x;
}

Vec3d YamlField::vector(const YamlRange& range) const {
  if (node_.kind() != YamlKind::sequence || node_.size() != 3) fail_type("three numbers");
  const auto component = [&](size_t i) { return YamlField(node_.item(i), key_).number(range); };
  return {component(0), component(1), component(2)};
}

bool YamlField::boolean() const {
  if (node_.kind() == YamlKind::scalar && !node_.is_quoted()) {
    if (is_one_of(node_.text(), {"true", "True", "TRUE"})) return true;
    if (is_one_of(node_.text(), {"false", "False", "FALSE"})) return false;
  }
  fail_type("true or false");
}

std::string YamlField::text() const {
  if (node_.kind() != YamlKind::scalar) fail_type("a text");
  if (node_.text().empty()) fail("must not be empty");
  if (node_.text().find('\0') != std::string_view::npos) fail("must not have a zero byte");  // files have names without
  return std::string(node_.text());
}

YamlMap::YamlMap(const YamlField& map, std::span<const std::string_view> keys, std::string noun)
    : node_(map.node()), keys_(keys), noun_(std::move(noun)), pairs_(keys.size(), kAbsent) {
  if (node_.kind() != YamlKind::map) map.fail_type("a map");
  for (size_t i = 0; i < node_.size(); ++i) {
    const YamlNode key = node_.key(i);
    if (key.kind() != YamlKind::scalar)
      key.fail(fmt::format("expected a key of {}, found {}", noun_, key.description()));
    if (key.text() == "<<" && !key.is_quoted()) key.fail("merge keys ('<<') are not supported");
    const auto known = std::find(keys_.begin(), keys_.end(), key.text());
    if (known == keys_.end()) {
      key.fail(fmt::format("unknown key {} of {}", quoted(key.text()), noun_) + suggestion(key.text(), keys_));
    }
    uint32_t& pair = pairs_[static_cast<size_t>(known - keys_.begin())];
    if (pair != kAbsent) refuse_both(node_.key(pair), key);
    pair = static_cast<uint32_t>(i);
  }
}

uint32_t YamlMap::pair_of(std::string_view key) const {
  return pairs_[static_cast<size_t>(std::find(keys_.begin(), keys_.end(), key) - keys_.begin())];
}

std::optional<YamlField> YamlMap::find(std::string_view key) const {
  const uint32_t pair = pair_of(key);
  if (pair == kAbsent) return std::nullopt;
  return YamlField(node_.value(pair), key);
}

YamlField YamlMap::require(std::string_view key) const {
  if (const std::optional<YamlField> field = find(key)) return *field;
  node_.fail(fmt::format("{} needs '{}'", noun_, key));
}

std::optional<YamlField> YamlMap::find_either(std::string_view word, std::string_view other) const {
  const std::optional<YamlField> one = find(word), two = find(other);
  if (one && two) refuse_both(key_node(word), key_node(other));
  return one ? one : two;
}

YamlNode YamlMap::key_node(std::string_view key) const { return node_.key(pair_of(key)); }

void refuse_both(const YamlNode& key, const YamlNode& other, std::string_view reason) {
  const YamlNode &first = key.is_before(other) ? key : other, &second = key.is_before(other) ? other : key;
  if (first.text() == second.text()) {
    second.fail(fmt::format("a second {}; the first is in line {}", quoted(second.text()), first.line()));
  }
  second.fail(fmt::format("'{}' and '{}' of line {} exclude each other{}{}", second.text(), first.text(), first.line(),
                          reason.empty() ? "" : ": ", reason));
}

std::optional<YamlField> peek(const YamlField& map, std::string_view key) {
  if (map.node().kind() != YamlKind::map) map.fail_type("a map");
  for (size_t i = 0; i < map.node().size(); ++i) {
    const YamlNode word = map.node().key(i);
    if (word.kind() == YamlKind::scalar && word.text() == key) return YamlField(map.node().value(i), key);
  }
  return std::nullopt;
}

std::vector<YamlField> items_of(const YamlField& list) {
  std::vector<YamlField> items;
  if (list.node().is_null()) return items;
  if (list.node().kind() != YamlKind::sequence) list.fail_type("a list");
  items.reserve(list.node().size());
  for (size_t i = 0; i < list.node().size(); ++i) {
    items.emplace_back(list.node().item(i), list.key());
    if (items.back().node().is_null()) items.back().fail(fmt::format("item {} of the list is empty", i + 1));
  }
  return items;
}

}  // namespace kerf
