#pragma once

#include <initializer_list>
#include <span>
#include <string_view>

#include <CLI/CLI.hpp>

// The subcommands of the second executable, osteon-studies: benchmarks, charts, failures, studies, and the
// manual, which describes both. Running a cell needs none of them, so `osteon` does not link them: for these
// subcommands it starts osteon-studies.

namespace osteon::app {

/// A subcommand's name and its line of help.
struct StudyCommand {
  std::string_view name, what;
};

/// The only list of these subcommands. The help, the start of osteon-studies and the launcher use it.
[[nodiscard]] std::span<const StudyCommand> StudyCommands();

/// Adds a subcommand of the list, with its line of help. osteon-studies then adds the subcommand's options;
/// `osteon` only lists it in the help. @throws std::out_of_range for a name that is not in the list.
CLI::App* AddStudy(CLI::App& app, std::string_view name);

/// Adds these subcommands to the help of `osteon`, after the subcommands that it already lists.
void AnnounceStudies(CLI::App& app, std::initializer_list<std::string_view> names);

/// Whether a command line names one of the StudyCommands(). Options of `osteon` itself may precede the name.
[[nodiscard]] bool AsksForStudy(int argc, char** argv);

/// Replaces this process by osteon-studies, which is in the same folder as this program, with the same
/// command line. @returns the exit code if that fails; stderr then shows how to build osteon-studies.
[[nodiscard]] int BecomeStudies(char** argv);

}  // namespace osteon::app
