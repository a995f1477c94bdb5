#include "kerf/scene/pipeline.h"

#include <algorithm>

#include "kerf/base/error.h"
#include "kerf/base/nearest_word.h"

namespace kerf {
namespace {

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/// Reads a pipeline from left to right.
class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}

  Pipeline parse() {
    Pipeline pipeline;
    while (true) {
      add_stage(pipeline);
      skip_spaces();
      if (at_ == text_.size()) break;
      if (!take('+')) fail("expected '+', '(' or the end, not '" + std::string(1, text_[at_]) + "'");
    }
    check_order(pipeline);
    return pipeline;
  }

 private:
  [[noreturn]] void fail(const std::string& sentence) const { fail_at(at_, sentence); }
  [[noreturn]] void fail_at(size_t at, const std::string& sentence) const {
    throw Error(ErrorCode::invalid_option, "structure '" + std::string(text_) + "', column " + std::to_string(at + 1),
                sentence);
  }

  void skip_spaces() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
  }
  bool take(char c) {
    skip_spaces();
    if (at_ == text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  std::string_view parse_name(const char* what) {
    skip_spaces();
    const size_t begin = at_;
    while (at_ < text_.size() && is_name_character(text_[at_])) ++at_;
    if (at_ == begin) fail(std::string("expected ") + what);
    return text_.substr(begin, at_ - begin);
  }

  /// A preset is all the stages that it stands for.
  void add_stage(Pipeline& pipeline) {
    const Stage stage = parse_stage();
    const auto* preset = std::get_if<const PresetEntry*>(&stage.entry->entry);
    pipeline.ends_with_preset = preset != nullptr;
    if (preset == nullptr) {
      pipeline.stages.push_back(stage);
      return;
    }
    for (const Stage& meant : Parser((*preset)->pipeline).parse().stages) pipeline.stages.push_back(meant);
    starts_.resize(pipeline.stages.size(), starts_.back());
  }

  Stage parse_stage() {
    skip_spaces();
    const size_t begin = at_;
    starts_.push_back(begin);
    const std::string_view name = parse_name("the name of a preset, splitter, builder, optimiser, layout or structure");
    const std::span<const MenuEntry> all = menu();
    const auto found = std::find_if(all.begin(), all.end(), [&](const MenuEntry& entry) { return entry.name == name; });
    if (found == all.end()) fail_at(begin, unknown(name));
    Stage stage{&*found, OptionValues(found->options)};
    if (!take('(')) return stage;
    if (take(')')) return stage;
    do {
      parse_option(stage);
    } while (take(','));
    if (!take(')')) fail("expected ',' or ')'");
    return stage;
  }

  void parse_option(Stage& stage) {
    skip_spaces();
    const size_t begin = at_;
    const std::string_view name = parse_name("the name of an option");
    if (!take('=')) {
      if (name == "auto" && set_automatic(stage, begin)) return;
      fail("expected '=' and a value after '" + std::string(name) + "'");
    }
    const std::string_view value = parse_value();
    try {
      stage.options.set(stage.entry->name, name, value);
    } catch (const Error& error) {
      fail_at(begin, error.what());
    }
  }

  /// "auto" alone stands for that value of the option that takes it; false if there is none.
  bool set_automatic(Stage& stage, size_t begin) const {
    for (const OptionSpec& spec : stage.entry->options) {
      if (!spec.may_be_auto) continue;
      try {
        stage.options.set(stage.entry->name, spec.name, kAutomatic);
      } catch (const Error& error) {
        fail_at(begin, error.what());
      }
      return true;
    }
    return false;
  }

  /// A number or a word.
  std::string_view parse_value() {
    skip_spaces();
    constexpr std::string_view kSigns = ".+-";
    const size_t begin = at_;
    while (at_ < text_.size() && (is_name_character(text_[at_]) || kSigns.find(text_[at_]) != kSigns.npos)) ++at_;
    if (at_ == begin) fail("expected a value");
    return text_.substr(begin, at_ - begin);
  }

  static std::string unknown(std::string_view name) {
    std::vector<std::string_view> names;
    for (const MenuEntry& entry : menu()) names.push_back(entry.name);
    return "unknown name '" + std::string(name) + "'" + suggestion(name, names);
  }

  void check_order(const Pipeline& pipeline) const {
    const size_t last = pipeline.stages.size() - 1;
    for (size_t i = 0; i <= last; ++i) {
      const std::string_view kind = pipeline.stages[i].entry->kind;
      const std::string name(pipeline.stages[i].entry->name);
      const std::string_view before = i > 0 ? pipeline.stages[i - 1].entry->kind : "";
      const bool takes_tree = pipeline.stages[i].entry->takes_tree();
      if (takes_tree && before != "builder" && before != "optimiser") {
        if (before == "layout") fail_at(starts_[i], "nothing can follow a layout");
        fail_at(starts_[i], "a builder must stand before " + name + ", as in binned_sah+" + name);
      }
      // Its cap counts references for each primitive, and to a second one pieces would pass for primitives.
      if (kind == "splitter" && before == "splitter") fail_at(starts_[i], "references can be split once only");
      if (!takes_tree && !before.empty() && before != "splitter") {
        fail_at(starts_[i], "only optimisers and a layout can follow a builder, and nothing a layout or structure");
      }
      if (i == last && kind == "splitter") {
        fail_at(starts_[i], "a builder must follow " + name + ", as in " + name + "+binned_sah");
      }
      const auto* structure = std::get_if<const StructureEntry*>(&pipeline.stages[i].entry->entry);
      if (structure != nullptr && !before.empty() && !(*structure)->takes_pieces) {
        fail_at(starts_[i], name + " takes whole primitives: no splitter can stand before it");
      }
    }
  }

  std::string_view text_;
  size_t at_ = 0;
  std::vector<size_t> starts_;
};

}  // namespace

std::string Pipeline::text() const {
  std::string text;
  for (const Stage& stage : stages) {
    if (!text.empty()) text += '+';
    text += stage.entry->name;
    const auto given = stage.options.given();
    for (size_t i = 0; i < given.size(); ++i) {
      text += (i == 0 ? "(" : ",") + std::string(given[i].first) + "=" + given[i].second;
    }
    if (!given.empty()) text += ')';
  }
  return text;
}

Pipeline parse_pipeline(std::string_view text) { return Parser(text).parse(); }

std::vector<std::string> split_pipeline_list(std::string_view text) {
  std::vector<std::string> list(1);
  int open = 0;
  for (const char c : text) {
    open += c == '(' ? 1 : c == ')' ? -1 : 0;
    if (c == ',' && open == 0) {
      list.emplace_back();
    } else {
      list.back() += c;
    }
  }
  for (const std::string& member : list) {
    if (member.find_first_not_of(' ') == std::string::npos) {
      throw Error(ErrorCode::invalid_option, "structures '" + std::string(text) + "'", "a member of the list is empty");
    }
  }
  return list;
}

}  // namespace kerf
