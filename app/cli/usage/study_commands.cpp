#include "app/cli/usage/study_commands.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

#include <fmt/format.h>

namespace osteon::app {
namespace {

constexpr std::array kStudies = std::to_array<StudyCommand>({
    {"pack", "fills a mesh or a shape with spheres and mass points, and measures the result"},
    {"failures", "runs the scenarios in which plain cutting methods fail and Osteon must not"},
    {"bench", "measures how long the parts take"},
    {"chart", "measures and draws charts"},
    {"assess", "measures and scores a session against its plan"},
    {"calibrate", "finds tool centre point, payload and sensor bias from recorded poses"},
    {"capability", "maps the force that the arm can hold, and finds a good place for its base"},
    {"transparency", "compares what a hand feels at the handle with what the law asks for"},
    {"identify", "measures arm, force sensor and link of a cell, for tune"},
    {"plan", "finds the coarsest model of a scene that meets an error and a rate"},
    {"surgical-plan", "checks a plan of a cup: its axis in all definitions, volume and walls"},
    {"tune", "maps where the loop is stable, and recommends gains"},
    {"regress", "runs scenarios in virtual time and compares them with their golden traces"},
    {"validate", "sets simulated beside published measurements of reaming and drilling"},
    {"soak",
     "runs the simulated cell for hours, in virtual time or as processes, with faults, and checks its "
     "balances"},
    {"diff", "compares two runs by their recordings: figures, faults, limits, configuration"},
    {"merge", "puts the parts of a study together that --shard has computed"},
    {"manual", "prints the manual page of all subcommands, or writes it to files"},
    {"completion", "prints the script by which a shell completes osteon"},
});

}  // namespace

std::span<const StudyCommand> StudyCommands() { return kStudies; }

CLI::App* AddStudy(CLI::App& app, std::string_view name) {
  const auto study = std::ranges::find(kStudies, name, &StudyCommand::name);
  if (study == kStudies.end()) throw std::out_of_range(fmt::format("{} is not in the list of studies", name));
  return app.add_subcommand(std::string(study->name), std::string(study->what));
}

void AnnounceStudies(CLI::App& app, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) AddStudy(app, name);
}

bool AsksForStudy(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--config-root") {
      ++i;  // skips the option's value
    } else if (!word.starts_with('-')) {
      return std::ranges::find(kStudies, word, &StudyCommand::name) != kStudies.end();
    }
  }
  return false;
}

int BecomeStudies(char** argv) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string studies = (self.parent_path() / "osteon-studies").string();
  execv(studies.c_str(), argv);
  fmt::print(stderr, "osteon: {}: {}; ./osteon builds it, or the target osteon_studies\n", studies,
             std::strerror(errno));
  return 2;
}

}  // namespace osteon::app
