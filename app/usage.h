#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

// Answers to a command line that is wrong: found …, accepted …, in one line.

namespace osteon::app {

/// A finite number from min to max. CLI11 puts the option's name before the text.
[[nodiscard]] CLI::Validator NumberWithin(double min, double max);
/// A whole number from 0 to 65535.
[[nodiscard]] CLI::Validator PortNumber();
[[nodiscard]] CLI::Validator OneOf(const std::vector<std::string>& words);

/// What is wrong, after the name of the subcommand that was asked for; an unknown word with the nearest known
/// one.
[[nodiscard]] std::string UsageError(const CLI::App& app, const CLI::ParseError& error);

/// What keeps any subcommand from its work, after the name of the one that was asked for: `--json -`, a
/// folder for temporary files that is not there. Empty: nothing.
[[nodiscard]] std::string WhyNotToBegin(const CLI::App& app);

}  // namespace osteon::app
