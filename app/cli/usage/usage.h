#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

// Validators of option values, options that several commands share, and error texts for a wrong command line
// ("found …, accepted …" in one line). Each validator's description says what it accepts;
// help/command_table.h reads the descriptions for help and manual.

namespace osteon::app {

/// Accepts a finite number from min to max. CLI11 puts the option's name before the text.
[[nodiscard]] CLI::Validator NumberWithin(double min, double max);
/// Accepts a whole number from 0 to 65535.
[[nodiscard]] CLI::Validator PortNumber();
[[nodiscard]] CLI::Validator OneOf(const std::vector<std::string>& words);

/// Adds `--device`.
void AddDeviceOption(CLI::App& sub, std::string& device);
/// Adds `--engine`. @param names  the accepted names, including "auto"
/// @param use  purpose of the engine, as text for the help; @param rest  text after the explanation of "auto"
void AddEngineOption(CLI::App& sub, std::string& engine, const std::vector<std::string>& names,
                     const std::string& use, const std::string& rest = "");

/// Explains a parse error, after the name of the requested subcommand. For an unknown word, names the nearest
/// known word.
[[nodiscard]] std::string UsageError(const CLI::App& app, const CLI::ParseError& error);

/// Returns why no subcommand could work with this command line, after the name of the requested subcommand:
/// `--json -`, an output that would overwrite a file to be kept, or a missing folder for temporary files.
/// Empty if the command can run.
[[nodiscard]] std::string ValidateEnvironment(const CLI::App& app);

}  // namespace osteon::app
