#include "app/calibrate_command.h"

#include <fmt/format.h>

#include "app/cell_file.h"
#include "app/usage.h"

namespace osteon::app {

CalibrateCommand::CalibrateCommand(CLI::App& app)
    : sub_(app.add_subcommand("calibrate", "what hangs on the flange, from recorded poses")) {
  sub_->add_option("cell", cell_, "a cell's YAML file, or a name under cells/")->required();
  sub_->add_option("--payload", options_.payload,
                   "a recording with 4 rests or more, tilted about two axes, nobody at the handle: mass, its "
                   "centre, the sensor's bias")
      ->check(CLI::ExistingFile);
  sub_->add_option("--pivot", options_.pivot,
                   "a recording with 4 rests or more, the tool's tip on one point: where the tip is")
      ->check(CLI::ExistingFile);
  sub_->add_option("--out", options_.out, "what the cell's file names as its calibration")
      ->capture_default_str();
  sub_->add_option("--json", options_.json, "write the figures there");
  sub_->footer(
      "Record with `osteon run CELL --record FILE`: half a second or more at each pose.\n\n"
      "Examples:\n  osteon calibrate my_cell.yaml --payload weigh.mcap\n"
      "  osteon calibrate my_cell.yaml --payload weigh.mcap --pivot tip.mcap --out my_calibration.yaml");
}

int CalibrateCommand::Run(const std::filesystem::path& config_root, const std::string& command_line) {
  const auto refuse = [](const std::string& what) {
    fmt::print(stderr, "osteon calibrate: {}\n", what);
    return 2;
  };
  if (options_.payload.empty() && options_.pivot.empty())
    return refuse("found neither --payload nor --pivot, accepted one of them or both");
  const auto found = FindCell(config_root, cell_);
  if (!found) return refuse(found.error());
  options_.cell = *found;
  options_.command_line = command_line;
  return RunCalibrate(options_);
}

}  // namespace osteon::app
