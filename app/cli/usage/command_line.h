#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include <CLI/CLI.hpp>

// The steps around the subcommands of both executables: prepare the parser, parse, run, report errors.

namespace osteon::app {

/// Returns the shell command that repeats this run: "./osteon" and the program's arguments, quoted if
/// necessary.
[[nodiscard]] std::string CommandLine(int argc, char** argv);
/// Returns the same command, given the words after the program's name.
[[nodiscard]] std::string CommandLine(std::span<const std::string> words);

/// Prepares the top of a tree of subcommands: form of the help, --version, --config-root (by default
/// config::FindShippedFolder).
void PrepareTop(CLI::App& app, std::filesystem::path& config_root);

/// Parses a command line. @returns nothing if the command must now run; else the exit code: help or version
/// was printed, or a word is wrong.
[[nodiscard]] std::optional<int> ParseCommandLine(CLI::App& app, int argc, char** argv);

/// Body of a main function: sets up the output, calls `run`, and turns an exception into a message and an
/// exit code.
[[nodiscard]] int RunMain(const std::function<int()>& run);

}  // namespace osteon::app
