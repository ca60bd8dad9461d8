#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include <CLI/CLI.hpp>

// What both executables do around their subcommands: prepare the parser, parse, run, report errors.

namespace osteon::app {

/// Returns the shell command that repeats this run: "./osteon" and the program's arguments, quoted if
/// necessary.
[[nodiscard]] std::string CommandLine(int argc, char** argv);
/// Returns the same, from the words after the program's name.
[[nodiscard]] std::string CommandLine(std::span<const std::string> words);

/// Prepares the top of a tree of subcommands: form of the help, --version, --config-root (by default
/// config::FindShippedFolder).
void PrepareTop(CLI::App& app, std::filesystem::path& config_root);

/// Parses a command line. @returns the exit code if nothing is left to do: help, version, a wrong word.
[[nodiscard]] std::optional<int> ParseCommandLine(CLI::App& app, int argc, char** argv);

/// The body of a main function: installs the output, and turns exceptions into a message and an exit code.
[[nodiscard]] int RunMain(const std::function<int()>& run);

}  // namespace osteon::app
