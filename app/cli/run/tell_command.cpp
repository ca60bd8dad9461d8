#include "app/cli/subcommands.h"

#include <string>
#include <vector>

#include "session/run/ask_running_cell.h"

namespace osteon::app {
namespace {

class TellCommand final : public Subcommand {
 public:
  explicit TellCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation&) override;

 private:
  session::TellOptions options_;
  std::vector<std::string> words_;
};

TellCommand::TellCommand(CLI::App& app)
    : Subcommand(app.add_subcommand(
          "tell", "asks a running session: next tool, undo, save, finish, and what a cell is asked")) {
  sub_->add_option("session", options_.session, "the session's folder, or the name of the running cell")
      ->type_name("FOLDER|CELL")
      ->required();
  sub_->add_option("request", words_,
                   "next, tool D (mm), undo, save, cup, guidance G (0 to 1), finish, pause, resume, stop or "
                   "status; \"confirmed\" after next or tool: a person has mounted this size; after finish: "
                   "although the plan is not finished")
      ->type_name("REQUEST")
      ->required()
      ->expected(1, 3);
  sub_->add_option("--json", options_.json, "also write the answer there, as JSON")->type_name("FILE");
  sub_->footer(
      "Tool and bone change only while the cell is paused and the tool is clear: retract it, then pause.\n\n"
      "Exit code 1: refused (the reason is said), or no cell runs this session\n\n"
      "Examples:\n  osteon tell first_hip pause\n  osteon tell first_hip next\n  osteon tell first_hip tool "
      "48\n"
      "  osteon tell first_hip undo\n  osteon tell first_hip finish\n"
      "  osteon tell demo status --json status.json");
}

int TellCommand::Run(const Invocation&) {
  for (const std::string& word : words_) options_.request += (options_.request.empty() ? "" : " ") + word;
  return session::RunTell(options_);
}

}  // namespace

void AddTellCommand(CLI::App& app, Subcommands& all) { all.push_back(std::make_unique<TellCommand>(app)); }

}  // namespace osteon::app
