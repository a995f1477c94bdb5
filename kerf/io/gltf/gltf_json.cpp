#include "kerf/io/gltf/gltf_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <bitset>
#include <charconv>
#include <limits>

#include "kerf/base/error.h"
#include "kerf/io/gltf/gltf_rules.h"
#include "kerf/io/message.h"

namespace kerf {
namespace {

constexpr int kDeepest = 100;

// What tinygltf is given of the members of the root.
constexpr std::string_view kKept[] = {"accessors", "asset",    "bufferViews", "cameras", "extensionsRequired",
                                      "materials", "meshes",   "nodes",       "scene",   "extensionsUsed",
                                      "scenes",    "textures", "samplers"};

int hex_digit(char c) {
  if ('0' <= c && c <= '9') return c - '0';
  if ('a' <= c && c <= 'f') return c - 'a' + 10;
  if ('A' <= c && c <= 'F') return c - 'A' + 10;
  return -1;
}

void append_utf8(std::string& text, uint32_t code) {
  const auto byte = [&](uint32_t bits) { text += static_cast<char>(bits); };
  if (code < 0x80) return byte(code);
  if (code < 0x800) {
    byte(0xC0 | code >> 6);
  } else if (code < 0x10000) {
    byte(0xE0 | code >> 12);
    byte(0x80 | (code >> 6 & 0x3F));
  } else {
    byte(0xF0 | code >> 18);
    byte(0x80 | (code >> 12 & 0x3F));
    byte(0x80 | (code >> 6 & 0x3F));
  }
  byte(0x80 | (code & 0x3F));
}

/// The four hexadecimal digits from `at` on; more than 16 bits where they are none.
uint32_t hex4(std::string_view text, size_t at) {
  if (text.size() < 4 || at > text.size() - 4) return ~0U;
  uint32_t code = 0;
  for (size_t i = at; i < at + 4; ++i) {
    const int digit = hex_digit(text[i]);
    if (digit < 0) return ~0U;
    code = code << 4 | static_cast<uint32_t>(digit);
  }
  return code;
}

enum class Token { object, array, string, number, boolean, null };

/// Walks through the text once. What is wrong with it as JSON is thrown at once; what is wrong with it as glTF is kept
/// until the end, as a file of another version breaks these rules first of all.
class Scanner {
 public:
  Scanner(std::string_view text, const std::string& path) : text_(text), path_(path) {}

  GltfText run() {
    if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;
    value(0);
    skip_space();
    if (at_ < text_.size() && text_[at_] != '\0') fail("expected the end of the file");
    if (version_.empty()) throw Error(ErrorCode::file, path_, "is no glTF 2.0: it has no asset.version");
    if (!version_.starts_with("2.")) {
      throw Error(ErrorCode::file, path_,
                  fmt::format("is glTF of version {}; only 2 can be read", printable(version_)));
    }
    if (!violation_.empty()) throw Error(ErrorCode::file, path_, violation_);
    cut();
    return std::move(result_);
  }

 private:
  struct Step {
    std::string_view key;  // in an object
    size_t index = 0;      // in an array
  };

  [[noreturn]] void fail(std::string_view sentence) const {
    const std::string_view before = text_.substr(0, at_);
    const auto line = std::count(before.begin(), before.end(), '\n') + 1;
    const size_t last = before.rfind('\n');
    const size_t column = at_ - (last == std::string_view::npos ? 0 : last + 1) + 1;
    throw Error(ErrorCode::file, path_, fmt::format("is no JSON at line {}, column {}: {}", line, column, sentence));
  }

  void skip_space() {
    while (at_ < text_.size() && std::string_view(" \t\r\n").find(text_[at_]) != std::string_view::npos) ++at_;
  }

  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  void expect(char c) {
    skip_space();
    if (peek() != c) fail(at_ < text_.size() ? fmt::format("expected '{}'", c) : "the text is cut short");
    ++at_;
  }

  void value(int depth) {
    skip_space();
    const size_t begin = at_;
    const GltfRule* rule = find_gltf_rule(pattern_);
    const char c = peek();
    Token token = Token::null;
    if (c == '{' || c == '[') {
      token = c == '{' ? Token::object : Token::array;
      if (depth == kDeepest) fail("nested deeper than 100");
      check(rule, token, {});
      begin_container(token);
      c == '{' ? object(depth + 1) : array(depth + 1);
      if (depth == 1 && std::find(std::begin(kKept), std::end(kKept), pattern_) == std::end(kKept)) {
        cuts_.emplace_back(begin, at_);
      }
      return;
    }
    if (c == '"') {
      token = Token::string;
      const std::string_view inside = string();
      check(rule, token, inside);
      keep_string(inside);
    } else if (c == '-' || ('0' <= c && c <= '9')) {
      token = Token::number;
      while (at_ < text_.size() && std::string_view("+-.eE0123456789").find(text_[at_]) != std::string_view::npos)
        ++at_;
      const std::string_view digits = text_.substr(begin, at_ - begin);
      check(rule, token, digits);
      keep_number(digits);
    } else {
      const std::string_view word = literal();
      check(rule, word == "null" ? Token::null : Token::boolean, word);
    }
  }

  std::string_view literal() {
    for (const std::string_view word : {"true", "false", "null"}) {
      if (text_.substr(at_).starts_with(word)) {
        at_ += word.size();
        return word;
      }
    }
    fail(at_ < text_.size() ? "expected a value" : "the text is cut short");
  }

  std::string_view string() {
    expect('"');
    const size_t begin = at_;
    while (true) {
      const size_t quote = text_.find('"', at_);
      if (quote == std::string_view::npos) fail("a string without an end");
      size_t first = quote;
      while (first > begin && text_[first - 1] == '\\') --first;
      at_ = quote + 1;
      if ((quote - first) % 2 == 0) return text_.substr(begin, quote - begin);
    }
  }

  void object(int depth) {
    ++at_;
    skip_space();
    if (peek() == '}') {
      ++at_;
      return;
    }
    const size_t length = pattern_.size();
    std::bitset<kGltfRuleCount + 1> seen;
    do {
      skip_space();
      const std::string_view raw = string();
      extend_pattern(raw);
      steps_.push_back({raw});
      check_repeat(seen);
      expect(':');
      value(depth);
      steps_.pop_back();
      pattern_.resize(length);
    } while (more('}'));
  }

  void array(int depth) {
    ++at_;
    skip_space();
    if (peek() == ']') {
      ++at_;
      return;
    }
    const size_t length = pattern_.size();
    pattern_ += "[]";
    steps_.push_back({{}, 0});
    do {
      value(depth);
      ++steps_.back().index;
    } while (more(']'));
    steps_.pop_back();
    pattern_.resize(length);
  }

  bool more(char closing) {
    skip_space();
    if (peek() == ',') {
      ++at_;
      return true;
    }
    expect(closing);
    return false;
  }

  void extend_pattern(std::string_view raw) {
    if (!pattern_.empty()) pattern_ += '.';
    const std::string key = unescape_json(raw);
    pattern_ += key.empty() || key.find_first_of(".[") != std::string::npos ? "?" : key;  // never like a path
  }

  void check_repeat(std::bitset<kGltfRuleCount + 1>& seen) {
    const GltfRule* rule = find_gltf_rule(pattern_);
    if (rule == nullptr || number_of(*rule) == kGltfRuleCount) return;
    if (seen[number_of(*rule)] && violation_.empty()) violation_ = fmt::format("{} stands twice", here());
    seen.set(number_of(*rule));
  }

  static bool fits(GltfType type, Token token, std::string_view text) {
    uint64_t number = 0;
    const auto is_integer = [&] {
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
      return token == Token::number && error == std::errc() && end == text.data() + text.size();
    };
    switch (type) {
      case GltfType::array:
        return token == Token::array;
      case GltfType::object:
        return token == Token::object;
      case GltfType::string:
        return token == Token::string;
      case GltfType::boolean:
        return token == Token::boolean;
      case GltfType::number:
        return token == Token::number;
      case GltfType::index:
        return is_integer() && number <= static_cast<uint64_t>(std::numeric_limits<int32_t>::max());
      case GltfType::size:
        return is_integer();
    }
    return false;
  }

  void check(const GltfRule* rule, Token token, std::string_view text) {
    if (rule == nullptr || fits(rule->type, token, text) || !violation_.empty()) return;
    const std::string what = token == Token::object   ? "an object"
                             : token == Token::array  ? "an array"
                             : token == Token::string ? quoted(text)
                                                      : printable(text);
    violation_ = fmt::format("{} is {}; expected {}", here(), what, expectation(rule->type));
  }

  /// Where we are, such as accessors[3].count.
  std::string here() const {
    std::string path;
    for (const Step& step : steps_) {
      if (step.key.data() == nullptr) {
        path += fmt::format("[{}]", step.index);
      } else {
        path += (path.empty() ? "" : ".") + printable(step.key);
      }
    }
    return path;
  }

  void begin_container(Token token) {
    if (token != Token::object) return;
    if (pattern_ == "animations[]") result_.has_animations = true;
    if (pattern_ == "buffers[]") result_.buffers.emplace_back();
    if (pattern_ == "images[]") result_.images.emplace_back();
  }

  void keep_string(std::string_view inside) {
    if (pattern_ == "asset.version") version_ = unescape_json(inside);
    if (pattern_ == "buffers[].uri" && !result_.buffers.empty()) result_.buffers.back().uri = inside;
    if (pattern_ == "images[].uri" && !result_.images.empty()) result_.images.back().uri = inside;
  }

  void keep_number(std::string_view digits) {
    uint64_t number = 0;
    if (std::from_chars(digits.data(), digits.data() + digits.size(), number).ec != std::errc()) return;
    if (pattern_ == "buffers[].byteLength" && !result_.buffers.empty()) result_.buffers.back().byte_length = number;
    if (pattern_ == "images[].bufferView" && !result_.images.empty()) result_.images.back().buffer_view = number;
  }

  void cut() {
    size_t from = 0;
    for (const auto& [begin, end] : cuts_) {
      result_.json.append(text_.substr(from, begin - from)).append("null");
      from = end;
    }
    result_.json.append(text_.substr(from));
  }

  std::string_view text_;
  const std::string& path_;
  size_t at_ = 0;
  std::string pattern_;  // the path to the current value, as rules have it
  std::vector<Step> steps_;
  std::string version_, violation_;
  std::vector<std::pair<size_t, size_t>> cuts_;
  GltfText result_;
};

}  // namespace

std::string unescape_json(std::string_view text) {
  std::string plain;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\' || i + 1 == text.size()) {
      plain += text[i];
      continue;
    }
    const char c = text[++i];
    const size_t known = std::string_view("bfnrt").find(c);
    if (c != 'u') {
      plain += known == std::string_view::npos ? c : "\b\f\n\r\t"[known];
      continue;
    }
    uint32_t code = hex4(text, i + 1);
    if (code > 0xFFFF) continue;  // tinygltf refuses such a text
    i += 4;
    const bool is_pair = (code & 0xFC00) == 0xD800 && text.substr(i + 1).starts_with("\\u");
    const uint32_t low = is_pair ? hex4(text, i + 3) : 0;
    if (is_pair && (low & 0xFFFFFC00) == 0xDC00) {
      code = 0x10000 + ((code & 0x3FF) << 10) + (low & 0x3FF);
      i += 6;
    }
    append_utf8(plain, code);
  }
  return plain;
}

GltfText take_gltf_apart(std::string_view text, const std::string& path) { return Scanner(text, path).run(); }

}  // namespace kerf
