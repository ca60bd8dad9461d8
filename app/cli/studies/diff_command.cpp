#include "app/cli/studies/studies.h"

#include <string>
#include <vector>

#include "app/cli/usage/study_commands.h"
#include "app/cli/usage/usage.h"
#include "studies/diff/diff.h"

namespace osteon::app {
namespace {

class DiffCommand final : public Subcommand {
 public:
  explicit DiffCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  studies::DiffOptions options_;
  std::vector<std::filesystem::path> recordings_;
};

DiffCommand::DiffCommand(CLI::App& app) : Subcommand(AddStudy(app, "diff")) {
  sub_->add_option("recordings", recordings_, "the .mcap files of the two runs")
      ->type_name("FILE")
      ->required()
      ->expected(2)
      ->check(CLI::ExistingFile);
  sub_->add_option(
          "--within", options_.within_percent,
          "a figure that differs by no more than this part of its size counts as the same, in percent")
      ->type_name("PERCENT")
      ->check(NumberWithin(0.0, 100.0))
      ->capture_default_str();
  sub_->add_option("--out", options_.out, "folder for diff.html, with both runs' curves")
      ->type_name("FOLDER");
  sub_->add_option("--json", options_.json, "write the comparison there")->type_name("FILE");
  sub_->footer(
      "Compares figures, faults, limits and configuration. Times that the machine took are shown, not "
      "judged.\n\n"
      "Exit code 1: a figure differs, or a fault is in one run alone\n\n"
      "Examples:\n  osteon diff before.mcap after.mcap\n  osteon diff a.mcap b.mcap --within 5 --out "
      "compared");
}

int DiffCommand::Run(const Invocation& invocation) {
  options_.recordings = {recordings_[0], recordings_[1]};
  options_.command_line = invocation.command_line;
  return studies::RunDiff(options_);
}

}  // namespace

void AddDiffCommand(CLI::App& app, Subcommands& all) { all.push_back(std::make_unique<DiffCommand>(app)); }

}  // namespace osteon::app
