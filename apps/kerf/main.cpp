// The command line: one file per subcommand, no logic of its own.

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <vector>

#include "apps/kerf/command.h"
#include "kerf/base/error.h"
#include "kerf/base/instruction_set.h"
#include "kerf/base/nearest_word.h"
#include "kerf/base/parallel.h"
#include "kerf/base/version.h"
#include "kerf/io/output_file.h"
#include "kerf/study/embree_builder.h"

namespace kerf::app {
namespace {

std::atomic<bool> interrupt_seen = false;
static_assert(std::atomic<bool>::is_always_lock_free);  // so that a signal handler may set it

void on_interrupt(int signal) {
  if (interrupt_seen.exchange(true)) std::_Exit(128 + signal);
}

/// "; did you mean ...?" for a word that no option or subcommand of the app has, else nothing.
std::string suggestion(const CLI::App& app, const std::string& word) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  const std::vector<std::string_view> menu(names.begin(), names.end());
  const std::string_view near = nearest_word(word.substr(0, word.find('=')), menu);
  return near.empty() ? "" : fmt::format("; did you mean '{}'?", near);
}

/// Says what is wrong with the words and ends with kUsage.
int refuse(const CLI::App& app, const std::string& sentence) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  fmt::print(stderr, "kerf: {}\nTry: kerf {}--help\n", sentence,
             chosen.empty() ? "" : chosen.front()->get_name() + " ");
  return kUsage;
}

/// The words that no option or subcommand took, a misspelt option first.
int refuse_extras(const CLI::App& app, const std::vector<std::string>& extras) {
  const auto option = std::find_if(extras.begin(), extras.end(), [](const auto& e) { return e.starts_with('-'); });
  const std::string& word = option != extras.end() ? *option : extras.front();
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  return refuse(app,
                fmt::format("unknown word '{}'{}", word, suggestion(chosen.empty() ? app : *chosen.front(), word)));
}

int run(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // a reader that went away is an error of write(), not the end of the program
  CLI::App app("Finds what rays hit in scenes with large and long thin triangles.", "kerf");
  app.set_version_flag("--version", fmt::format("kerf {} (tasks: {}, SIMD: {})", kVersion, task_backend(),
                                                fmt::join(instruction_sets(), ", ")));
  app.allow_extras();  // to name the nearest word, which CLI11 does not
  app.footer("Example: kerf render room.yaml -o room.png --spp 256");
  add_embree_builders();
  std::function<int()> command;
  add_render(app, command);
  add_figure(app, command);
  add_check(app, command);
  add_inspect(app, command);
  add_list(app, command);
  add_study(app, command);
  add_bench(app, command);
  add_make(app, command);
  add_convert(app, command);
  app.require_subcommand(0, 1);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    return refuse(app, error.what());
  }
  if (const std::vector<std::string> extras = app.remaining(true); !extras.empty()) return refuse_extras(app, extras);
  if (!command) {
    fmt::print("{}", app.help());
    return kDone;
  }
  return command();
}

}  // namespace

void write_json(const std::string& path, const nlohmann::ordered_json& figures) {
  const std::string text = figures.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  if (path == "-") {
    fmt::print("{}\n", text);
    return;
  }
  OutputFile file(path);
  file.write(text + "\n");
  file.commit();
}

void check_output(const std::string& path) {
  const std::filesystem::path file = path;
  std::filesystem::path folder = file.parent_path();
  if (folder.empty()) folder = ".";
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) throw Error(ErrorCode::file, path, "it is a folder");
  if (!std::filesystem::is_directory(folder, ignored)) {
    throw Error(ErrorCode::file, path, "there is no folder " + folder.string());
  }
  const bool exists = std::filesystem::exists(file, ignored);
  if (exists && access(path.c_str(), W_OK) != 0) throw Error(ErrorCode::file, path, "it cannot be written to");
  const bool is_replaced = !exists || std::filesystem::is_regular_file(file, ignored);
  if (is_replaced && access(folder.c_str(), W_OK) != 0) {
    throw Error(ErrorCode::file, path, "its folder cannot be written to");
  }
}

void watch_interrupts() {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
}

void end_at_interrupts() {
  std::signal(SIGINT, [](int signal) { std::_Exit(128 + signal); });
  std::signal(SIGTERM, [](int signal) { std::_Exit(128 + signal); });
}

void ignore_interrupts() {
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGTERM, SIG_IGN);
}

bool interrupted() { return interrupt_seen; }
const std::atomic<bool>* interrupt_flag() { return &interrupt_seen; }

}  // namespace kerf::app

int main(int argc, char** argv) {
  try {
    const int code = kerf::app::run(argc, argv);
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      fmt::print(stderr, "kerf: standard output cannot be written\n");
      return kerf::app::kBadInput;
    }
    return code;
  } catch (const kerf::Error& error) {
    if (error.code() == kerf::ErrorCode::stopped && kerf::app::interrupted()) {
      fmt::print(stderr, "kerf: interrupted\n");
      return kerf::app::kInterrupted;
    }
    fmt::print(stderr, "kerf: {}\n", error.what());
    const bool is_usage =
        error.code() == kerf::ErrorCode::invalid_option || error.code() == kerf::ErrorCode::invalid_argument;
    return is_usage ? kerf::app::kUsage : kerf::app::kBadInput;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "kerf: not enough memory\n");
    return kerf::app::kBadInput;
  } catch (const std::exception& error) {
    fmt::print(stderr, "kerf: {}\n", error.what());
    return kerf::app::kBadInput;
  }
}
