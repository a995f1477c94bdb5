#include "kerf/io/yaml/yaml_parse.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <istream>
#include <optional>
#include <streambuf>

#include "kerf/base/error.h"
#include "kerf/io/message.h"

namespace kerf {
namespace {

constexpr size_t kMostLevels = 64;
constexpr size_t kMostBytes = size_t{1} << 30;  // yaml-cpp counts in int

[[noreturn]] void fail(const std::string& name, size_t line, size_t column, const std::string& sentence) {
  throw Error(ErrorCode::file, fmt::format("{}:{}:{}", name, line, column), sentence);
}

/// A stream over text that is there already, without a copy.
class ViewBuffer : public std::streambuf {
 public:
  explicit ViewBuffer(std::string_view text) {
    // setg() wants bytes that may be written; nobody does: putting back another byte is refused by the base class.
    char* begin = const_cast<char*>(text.data());
    setg(begin, begin, begin + text.size());
  }
};

/// Builds the tree from what yaml-cpp reports. Its own nodes would keep no place of an alias, take ten times the memory
/// and come only after a text of a million brackets has been recursed into.
class TreeBuilder : public YAML::EventHandler {
 public:
  explicit TreeBuilder(const std::string& name) { tree_.name = name; }

  /// Where the last scalar that is not plain begins, or what stands before it: a byte of the text.
  std::optional<size_t> last_quoted() const { return last_quoted_; }

  YamlTree take() {
    if (tree_.nodes.empty()) tree_.nodes.emplace_back();
    return std::move(tree_);
  }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (has_document_) refuse(mark, "a second document; a scene is one");
    has_document_ = true;
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    YamlTree::Use use = place_of(mark);
    // yaml-cpp's mark of what is not there is where the next thing begins, maybe lines below.
    if (is_map_value()) {
      const YamlTree::Use& key = pending_.back();
      if (key.line == use.line && key.column == use.column) refuse(mark, "a key without a ':' behind it");
      use = key;
    } else if (!open_.empty() && open_.back().is_block_sequence) {
      use = open_.back().use;
    }
    use.node = add_node({YamlKind::null}, anchor);
    add(use);
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    if (anchor >= anchors_.size()) refuse(mark, "an alias of nothing");
    YamlTree::Use use = place_of(mark);
    use.node = anchors_[anchor];
    const auto is_it = [&](const Open& open) { return open.use.node == use.node; };
    if (std::any_of(open_.begin(), open_.end(), is_it)) refuse(mark, "an alias within what it stands for");
    add(use);
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    refuse_tag(mark, tag);
    if (tag == "!") last_quoted_ = static_cast<size_t>(mark.pos);
    YamlTree::Use use = place_of(mark);
    use.node = add_node(
        {YamlKind::scalar, tag == "!", static_cast<uint32_t>(tree_.text.size()), static_cast<uint32_t>(value.size())},
        anchor);
    tree_.text += value;
    add(use);
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value style) override {
    open(mark, tag, anchor, YamlKind::sequence, style != YAML::EmitterStyle::Flow);
  }
  void OnSequenceEnd() override { close(); }

  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, tag, anchor, YamlKind::map, false);
  }
  void OnMapEnd() override { close(); }

 private:
  /// A sequence or map of which not all is known.
  struct Open {
    YamlTree::Use use;
    size_t first_pending = 0;
    bool is_block_sequence = false;
  };

  static YamlTree::Use place_of(const YAML::Mark& mark) {
    return {0, static_cast<uint32_t>(mark.line) + 1, static_cast<uint32_t>(mark.column) + 1};
  }

  [[noreturn]] void refuse(const YAML::Mark& mark, const std::string& sentence) const {
    const YamlTree::Use place = place_of(mark);
    fail(tree_.name, place.line, place.column, sentence);
  }

  void refuse_tag(const YAML::Mark& mark, const std::string& tag) const {
    // yaml-cpp's words for no tag: "?" of what is plain, "!" of what is quoted.
    if (tag.empty() || tag == "?" || tag == "!") return;
    refuse(mark, fmt::format("tags are not supported, found {}", quoted(tag)));
  }

  bool is_map_value() const {
    return !open_.empty() && tree_.nodes[open_.back().use.node].kind == YamlKind::map &&
           (pending_.size() - open_.back().first_pending) % 2 == 1;
  }

  uint32_t add_node(const YamlTree::Node& node, YAML::anchor_t anchor) {
    const auto number = static_cast<uint32_t>(tree_.nodes.size());
    tree_.nodes.push_back(node);
    if (anchor != YAML::NullAnchor) {  // they are numbered from 1 without gaps
      if (anchor >= anchors_.size()) anchors_.resize(anchor + 1);
      anchors_[anchor] = number;
    }
    return number;
  }

  void add(const YamlTree::Use& use) {
    if (open_.empty()) {
      tree_.root = use;
    } else {
      pending_.push_back(use);
    }
  }

  void open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, YamlKind kind, bool is_block) {
    refuse_tag(mark, tag);
    if (open_.size() == kMostLevels) refuse(mark, fmt::format("more than {} levels", kMostLevels));
    YamlTree::Use use = place_of(mark);
    use.node = add_node({kind}, anchor);
    open_.push_back({use, pending_.size(), is_block});
  }

  void close() {
    const Open done = open_.back();
    open_.pop_back();
    YamlTree::Node& node = tree_.nodes[done.use.node];
    node.begin = static_cast<uint32_t>(tree_.uses.size());
    node.count = static_cast<uint32_t>(pending_.size() - done.first_pending);
    const auto first = pending_.begin() + static_cast<ptrdiff_t>(done.first_pending);
    tree_.uses.insert(tree_.uses.end(), first, pending_.end());
    pending_.erase(first, pending_.end());
    add(done.use);
  }

  YamlTree tree_;
  bool has_document_ = false;
  std::optional<size_t> last_quoted_;
  std::vector<uint32_t> anchors_;  // the node of each
  std::vector<Open> open_;
  std::vector<YamlTree::Use> pending_;  // the content of all that is open
};

/// Refuses bytes that stand in no YAML text. yaml-cpp would take one of them for the end of the file, without a word,
/// and guess UTF-16 from others.
void refuse_control_bytes(std::string_view text, const std::string& name) {
  size_t line = 1, line_begin = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte == '\n') {
      ++line;
      line_begin = i + 1;
    }
    const bool is_control = (byte < ' ' && byte != '\t' && byte != '\n' && byte != '\r') || byte == 0x7F;
    if (!is_control && byte < 0xFE) continue;
    fail(name, line, i - line_begin + 1,
         fmt::format("the byte \\x{:02x} is no part of a YAML text in UTF-8", static_cast<unsigned>(byte)));
  }
}

/// Refuses lines that begin with a percent sign, but for the version of YAML: yaml-cpp passes over what it does not
/// know, wherever it stands.
void refuse_directives(std::string_view text, const std::string& name) {
  for (size_t begin = 0, line = 1; begin < text.size(); ++line) {
    const std::string_view rest = text.substr(begin);
    if (rest.starts_with('%') && !rest.starts_with("%YAML ")) fail(name, line, 1, "directives ('%') are not supported");
    begin += std::min(rest.find('\n'), rest.size() - 1) + 1;
  }
}

/// Refuses a quoted text without an end, which yaml-cpp takes for one that ends with the file. It is the last one.
void refuse_open_quote(std::string_view text, size_t begin, const std::string& name) {
  // Anchors, and a tag that says no more than "text", stand before it.
  while (begin < text.size() && (text[begin] == '&' || text[begin] == '!' || text[begin] == '#')) {
    const size_t end = text[begin] == '#' ? text.find('\n', begin) : text.find_first_of(" \t\r\n", begin);
    begin = std::min(text.find_first_not_of(" \t\r\n", end), text.size());
  }
  if (begin == text.size() || (text[begin] != '\'' && text[begin] != '"')) return;
  for (size_t i = begin + 1; i < text.size(); ++i) {
    if (text[i] == '\\' && text[begin] == '"') {
      ++i;
    } else if (text[i] == text[begin]) {
      if (text[i] == '"' || i + 1 == text.size() || text[i + 1] != '\'') return;
      ++i;  // two single quotes are one in the text
    }
  }
  const std::string_view before = text.substr(0, begin);
  const auto line = static_cast<size_t>(std::count(before.begin(), before.end(), '\n'));
  fail(name, line + 1, begin - (before.rfind('\n') + 1) + 1, "the quoted text that begins here has no end");
}

std::string_view line_of(std::string_view text, size_t number) {
  for (; number > 0; --number) text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  return text.substr(0, text.find('\n'));
}

/// What yaml-cpp says, with its place.
[[noreturn]] void fail(const YAML::Exception& error, std::string_view text, const std::string& name) {
  std::string sentence = "no YAML: " + error.msg;
  if (std::any_of(sentence.begin(), sentence.end(), [](char c) { return c < ' ' || c > '~'; })) {
    sentence = "no YAML: " + printable(error.msg);
  }
  if (error.mark.is_null()) throw Error(ErrorCode::file, name, sentence);
  const std::string_view line = line_of(text, static_cast<size_t>(error.mark.line));
  const std::string_view indentation = line.substr(0, line.find_first_not_of(" \t"));
  if (indentation.find('\t') != std::string_view::npos)
    sentence += "; the line begins with a tab, where only spaces count";
  fail(name, static_cast<size_t>(error.mark.line) + 1, static_cast<size_t>(error.mark.column) + 1, sentence);
}

}  // namespace

YamlTree parse_yaml(std::string_view text, const std::string& name) {
  if (text.size() > kMostBytes) throw Error(ErrorCode::file, name, "a YAML file may have at most 2^30 bytes");
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // a byte order mark
  refuse_control_bytes(text, name);
  refuse_directives(text, name);
  TreeBuilder builder(name);
  ViewBuffer buffer(text);
  std::istream stream(&buffer);
  try {
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& error) {
    fail(error, text, name);
  }
  if (builder.last_quoted()) refuse_open_quote(text, *builder.last_quoted(), name);
  return builder.take();
}

}  // namespace kerf
