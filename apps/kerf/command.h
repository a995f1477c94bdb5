#pragma once

#include <CLI/CLI.hpp>
#include <atomic>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace kerf::app {

inline constexpr int kDone = 0, kBadInput = 1, kUsage = 2, kInterrupted = 130;

/// Adds one subcommand each; what it does is put into `run`, which returns the exit code.
void add_render(CLI::App& app, std::function<int()>& run);
void add_figure(CLI::App& app, std::function<int()>& run);
void add_check(CLI::App& app, std::function<int()>& run);
void add_inspect(CLI::App& app, std::function<int()>& run);
void add_list(CLI::App& app, std::function<int()>& run);
void add_study(CLI::App& app, std::function<int()>& run);
void add_bench(CLI::App& app, std::function<int()>& run);
void add_make(CLI::App& app, std::function<int()>& run);
void add_convert(CLI::App& app, std::function<int()>& run);

/// The view that is not one of rays' hits.
inline constexpr std::string_view kBeauty = "beauty";

/// Writes figures to a file, or to standard output for "-"; bytes that are no UTF-8 become replacement characters.
void write_json(const std::string& path, const nlohmann::ordered_json& figures);

/// Finds out before any work is done that a file could not be written: no such folder, a folder of that name, not
/// allowed. Throws Error (file).
void check_output(const std::string& path);

/// interrupted() becomes true at the first interrupt (Ctrl-C, SIGTERM); a second one ends the program at once.
void watch_interrupts();
/// An interrupt ends the program at once, with 128 and the signal's number, kInterrupted for Ctrl-C: for commands that
/// have nothing to write then.
void end_at_interrupts();
/// From now on interrupts are passed over: files are written to their end.
void ignore_interrupts();
bool interrupted();
/// The same for what looks at it by itself.
const std::atomic<bool>* interrupt_flag();

}  // namespace kerf::app
