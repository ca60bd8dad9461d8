#include "app/cli/studies/studies.h"

#include <string>

#include <fmt/format.h>

#include "app/cli/usage/cell_file.h"
#include "app/cli/usage/study_commands.h"
#include "app/cli/usage/usage.h"
#include "session/process/exit_code.h"
#include "studies/calibrate/calibrate.h"

namespace osteon::app {
namespace {

class CalibrateCommand final : public Subcommand {
 public:
  explicit CalibrateCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  studies::CalibrateOptions options_;
  std::string cell_;
};

CalibrateCommand::CalibrateCommand(CLI::App& app) : Subcommand(AddStudy(app, "calibrate")) {
  sub_->add_option("cell", cell_, "a name under cells/, or a cell's YAML file")
      ->type_name("CELL")
      ->required();
  sub_->add_option("--payload", options_.payload,
                   "recording with at least 4 rests, tilted about two axes, with no hand on the handle: "
                   "gives mass, centre of mass and the sensor's bias")
      ->type_name("FILE")
      ->check(CLI::ExistingFile);
  sub_->add_option("--pivot", options_.pivot,
                   "recording with at least 4 rests, the tool's tip on one point: gives the tip's place")
      ->type_name("FILE")
      ->check(CLI::ExistingFile);
  sub_->add_option("--out", options_.out,
                   "YAML file with the result, which the cell's file names as its calibration")
      ->type_name("FILE")
      ->capture_default_str();
  sub_->add_option("--json", options_.json, "also write the figures there, as JSON")->type_name("FILE");
  sub_->footer(
      "Record with `osteon run CELL --record FILE`: rest for at least half a second at each pose.\n\n"
      "Exit code 1: the poses do not determine the result, or a file could not be written\n\n"
      "Examples:\n  osteon calibrate my_cell.yaml --payload weigh.mcap\n"
      "  osteon calibrate my_cell.yaml --payload weigh.mcap --pivot tip.mcap --out my_calibration.yaml");
}

int CalibrateCommand::Run(const Invocation& invocation) {
  const auto refuse = [](const std::string& what) { return session::Fail("calibrate", what); };
  if (options_.payload.empty() && options_.pivot.empty())
    return refuse("found neither --payload nor --pivot, accepted one of them or both");
  const auto found = FindCell(invocation.config_root, cell_);
  if (!found) return refuse(found.error());
  options_.cell = *found;
  options_.command_line = invocation.command_line;
  return studies::RunCalibrate(options_);
}

}  // namespace

void AddCalibrateCommand(CLI::App& app, Subcommands& all) {
  all.push_back(std::make_unique<CalibrateCommand>(app));
}

}  // namespace osteon::app
