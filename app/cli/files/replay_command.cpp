#include "app/cli/subcommands.h"

#include <string>

#include "app/cli/usage/cell_file.h"
#include "session/procedure/replay_session.h"
#include "session/process/exit_code.h"
#include "session/replay/replay_recording.h"

namespace osteon::app {
namespace {

class ReplayCommand final : public Subcommand {
 public:
  explicit ReplayCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  session::ReplayOptions options_;
  std::string cell_;
};

ReplayCommand::ReplayCommand(CLI::App& app)
    : Subcommand(
          app.add_subcommand("replay", "runs the controller again on a recording's inputs and compares")) {
  sub_->add_option("recording", options_.recording,
                   "the .mcap file of a run; it may be torn. Or the folder of a session: all its recordings, "
                   "and the bone of each part again")
      ->type_name("FILE|FOLDER")
      ->required()
      ->check(CLI::ExistingPath);
  sub_->add_option("--cell", cell_,
                   "a cell's name or YAML file, to be used instead of the recorded configuration: what would "
                   "have been different")
      ->type_name("CELL");
  sub_->add_option("--json", options_.json, "also write the result there, as JSON")->type_name("FILE");
  sub_->footer(
      "The recording holds every input of the servo loop and the configuration: nothing else is read.\n\n"
      "Exit code 1: a bit differs, or a tick could not be run again\n\n"
      "Examples:\n  osteon replay demo_out/recording.mcap\n"
      "  osteon replay demo_out/recording.mcap --json replay.json\n"
      "  osteon replay demo_out/recording.mcap --cell softer.yaml\n"
      "  osteon replay demo_out/session");
}

int ReplayCommand::Run(const Invocation& invocation) {
  if (std::filesystem::is_directory(options_.recording)) {
    if (!cell_.empty())
      return session::Fail("replay", "--cell: found with a session's folder, accepted with a recording");
    return session::RunReplaySession({.session = options_.recording, .json = options_.json});
  }
  if (!cell_.empty()) {
    const auto found = FindCell(invocation.config_root, cell_);
    if (!found) return session::Fail("replay", "--cell " + found.error());
    options_.cell = *found;
  }
  return session::RunReplay(options_);
}

}  // namespace

void AddReplayCommand(CLI::App& app, Subcommands& all) {
  all.push_back(std::make_unique<ReplayCommand>(app));
}

}  // namespace osteon::app
