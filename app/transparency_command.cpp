#include "app/transparency_command.h"

#include <fmt/format.h>

#include "app/cell_file.h"
#include "app/usage.h"

namespace osteon::app {

TransparencyCommand::TransparencyCommand(CLI::App& app)
    : sub_(app.add_subcommand("transparency",
                              "what a hand feels at the handle beside what the law asks for")) {
  sub_->add_option("cell", cell_, "a cell's YAML file, or a name under cells/")->required();
  sub_->add_option("--out", options_.out, "folder for transparency.svg, .png, .csv, .json, .html")
      ->capture_default_str();
  sub_->add_option("--json", options_.json, "a further copy of transparency.json");
  sub_->add_option("--points", options_.points, "frequencies from 0.1 to 30 Hz")
      ->check(NumberWithin(3, 200))
      ->capture_default_str();
  sub_->add_option("--sensor-delay-count", options_.sensor_delay_ticks,
                   "ticks from the load on the sensor to the loop")
      ->check(NumberWithin(0, 100))
      ->capture_default_str();
  sub_->footer(
      "Simulated arm, virtual time: a known wrench shakes the handle, one frequency after the other.\n\n"
      "Examples:\n  osteon transparency demo\n  osteon transparency config/cells/molar.yaml --out molar "
      "--points 12");
}

int TransparencyCommand::Run(const std::filesystem::path& config_root, const std::string& command_line) {
  const auto found = FindCell(config_root, cell_);
  if (!found) {
    fmt::print(stderr, "osteon transparency: {}\n", found.error());
    return 2;
  }
  options_.cell = *found;
  options_.command_line = command_line;
  return RunTransparency(options_);
}

}  // namespace osteon::app
