#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

namespace kerf::app {

inline constexpr int kDone = 0, kBadInput = 1, kUsage = 2, kInterrupted = 130;

/// Adds one subcommand each; what it does is put into `run`, which returns the exit code.
void add_render(CLI::App& app, std::function<int()>& run);
void add_check(CLI::App& app, std::function<int()>& run);
void add_list(CLI::App& app, std::function<int()>& run);

/// Writes figures to a file, or to standard output for "-".
void write_json(const std::string& path, const std::string& text);

/// Becomes true at the first interrupt (Ctrl-C, SIGTERM); a second one ends the program at once.
void watch_interrupts();
bool interrupted();

}  // namespace kerf::app
