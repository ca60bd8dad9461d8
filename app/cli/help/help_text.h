#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

#include "app/cli/help/command_table.h"

// The text of --help. CLI11's own text does not break lines; this text fits the terminal.

namespace osteon::app {

/// The option with its value: "-o, --out FILE". If the accepted words are few and short, they replace the
/// value: "--mode a|b".
[[nodiscard]] std::string OptionHead(const OptionText& option);
/// The option's explanation, then what is accepted, the default, and which options it needs or excludes.
[[nodiscard]] std::string OptionBody(const OptionText& option);
/// The command's usage line: "osteon run [options] cell".
[[nodiscard]] std::string Synopsis(const CommandText& command);

/// The whole text of --help, in lines of at most `width` columns, but at least 50.
[[nodiscard]] std::string HelpText(const CommandText& command, std::size_t width);

/// Columns for the help: those of the terminal behind stdout, or $COLUMNS if that is set, but at least 50 and
/// at most 120; 80 if there is no terminal.
[[nodiscard]] std::size_t HelpWidth();

/// Makes CLI11 print HelpText. Set it in the top App before subcommands are added, since they copy it.
class HelpFormatter : public CLI::FormatterBase {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
};

}  // namespace osteon::app
