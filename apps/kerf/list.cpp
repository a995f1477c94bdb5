// kerf list: the menu.

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "apps/kerf/command.h"
#include "kerf/io/material.h"
#include "kerf/io/model.h"
#include "kerf/render/views.h"
#include "kerf/scene/menu.h"
#include "kerf/study/models/models.h"

namespace kerf::app {
namespace {

constexpr std::string_view kBeautySentence = "the path-traced picture";

nlohmann::ordered_json menu_json() {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const MenuEntry& entry : menu()) {
    nlohmann::ordered_json options = nlohmann::ordered_json::array();
    for (const OptionSpec& spec : entry.options) {
      // JSON has no infinity: it is the text "inf".
      const auto number = [](double x) -> nlohmann::ordered_json {
        return std::isinf(x) ? nlohmann::ordered_json("inf") : nlohmann::ordered_json(x);
      };
      options.push_back({{"name", spec.name},
                         {"sentence", spec.sentence},
                         {"default", number(spec.fallback)},
                         {"least", number(spec.least)},
                         {"most", number(spec.most)},
                         {"above_least", spec.above_least},
                         {"whole", spec.whole},
                         {"words", spec.words}});
    }
    all.push_back({{"kind", entry.kind},
                   {"name", entry.name},
                   {"sentence", entry.sentence},
                   {"source", entry.source},
                   {"options", options}});
  }
  const auto add = [&](std::string_view kind, std::string_view name, std::string_view sentence) {
    all.push_back({{"kind", kind},
                   {"name", name},
                   {"sentence", sentence},
                   {"source", ""},
                   {"options", nlohmann::ordered_json::array()}});
  };
  add("view", kBeauty, kBeautySentence);
  for (const ViewEntry& view : views()) add("view", view.name, view.sentence);
  for (const MaterialTypeEntry& type : material_types()) add("material", type.name, type.sentence);
  for (const ModelEntry& model : made_models()) add("model", model.name, model.sentence);
  for (const std::string& extension : model_extensions()) add("format", extension, "a model that can be read");
  return all;
}

void print_menu() {
  fmt::print(
      "A structure is a preset, or a pipeline: perhaps a splitter, then a builder, perhaps optimisers and perhaps a\n"
      "layout, or a structure, joined by '+', such as\n"
      "  early_split(auto)+binned_sah(bins=32)+reinsertion\n");
  std::string_view kind;
  for (const MenuEntry& entry : menu()) {
    if (entry.kind != kind) fmt::print("\n{}s\n", kind = entry.kind);
    fmt::print("  {:<18}{}\n", entry.name, entry.sentence);
    if (!entry.source.empty()) fmt::print("  {:<18}{}\n", "", entry.source);
    for (const OptionSpec& spec : entry.options) {
      const std::string words = spec.words.empty() ? "" : fmt::format(" (of {})", fmt::join(spec.words, ", "));
      fmt::print("  {:<20}{} = {}{}: {}\n", "", spec.name, spec.text_of(spec.fallback), words, spec.sentence);
    }
  }
  fmt::print("\nviews\n  {:<16}{}\n", kBeauty, kBeautySentence);
  for (const ViewEntry& view : views()) fmt::print("  {:<16}{}\n", view.name, view.sentence);
  fmt::print("\nmaterials of YAML scenes\n");
  for (const MaterialTypeEntry& type : material_types()) fmt::print("  {:<16}{}\n", type.name, type.sentence);
  fmt::print("\nmodels that kerf make makes\n");
  for (const ModelEntry& model : made_models()) fmt::print("  {:<16}{}\n", model.name, model.sentence);
  fmt::print("\nmodels that can be read\n ");
  size_t column = 2;
  for (const std::string& extension : model_extensions()) {
    if (column + extension.size() > 110) {
      fmt::print("\n ");
      column = 2;
    }
    fmt::print(" {}", extension);
    column += extension.size() + 1;
  }
  fmt::print("\n");
}

}  // namespace

void add_list(CLI::App& app, std::function<int()>& run) {
  CLI::App* command = app.add_subcommand(
      "list",
      "Prints all splitters, builders, optimisers, layouts, structures, views, materials, models and their formats.");
  command->footer("Example: kerf list --json -");
  auto json = std::make_shared<std::string>();
  command->add_option("--json", *json, "Write the menu to this file as JSON; '-' is standard output");
  command->add_option_function<int>(
      "--threads", [](int) {}, "Accepted, as by every command; there is nothing to share");
  command->add_flag("--quiet")->description("Accepted, as by every command; only what was asked for is printed anyway");
  command->callback([json, &run] {
    run = [json] {
      if (json->empty()) {
        print_menu();
      } else {
        write_json(*json, menu_json());
      }
      return kDone;
    };
  });
}

}  // namespace kerf::app
