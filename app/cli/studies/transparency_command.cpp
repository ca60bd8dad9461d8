#include "app/cli/studies/studies.h"

#include <string>

#include <fmt/format.h>

#include "app/cli/usage/cell_file.h"
#include "app/cli/usage/study_commands.h"
#include "app/cli/usage/usage.h"
#include "session/process/exit_code.h"
#include "studies/transparency/transparency.h"

namespace osteon::app {
namespace {

class TransparencyCommand final : public Subcommand {
 public:
  explicit TransparencyCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  studies::TransparencyOptions options_;
  std::string cell_;
};

TransparencyCommand::TransparencyCommand(CLI::App& app) : Subcommand(AddStudy(app, "transparency")) {
  sub_->add_option("cell", cell_, "a name under cells/, or a cell's YAML file")
      ->type_name("CELL")
      ->required();
  sub_->add_option("--out", options_.out, "folder for transparency.svg, .png, .csv, .json and .html")
      ->type_name("FOLDER")
      ->capture_default_str();
  sub_->add_option("--json", options_.json, "write a further copy of transparency.json there")
      ->type_name("FILE");
  sub_->add_option("--identified", options_.identified,
                   "a file of `osteon identify` for this cell: the simulated arm has what was measured")
      ->check(CLI::ExistingFile)
      ->type_name("FILE");
  sub_->add_option("--points", options_.points, "number of frequencies from 0.1 to 30 Hz")
      ->check(NumberWithin(3, 200))
      ->capture_default_str();
  sub_->add_option("--sensor-delay-count", options_.sensor_delay_ticks,
                   "delay from the load on the sensor to the loop, in ticks")
      ->check(NumberWithin(0, 100))
      ->capture_default_str();
  sub_->footer(
      "Simulated arm, virtual time: a known wrench shakes the handle, one frequency after the other.\n\n"
      "Exit code 1: the verdict is bad, or a file could not be written\n\n"
      "Examples:\n  osteon transparency demo\n  osteon transparency config/cells/molar.yaml --out molar "
      "--points 12");
}

int TransparencyCommand::Run(const Invocation& invocation) {
  const auto found = FindCell(invocation.config_root, cell_);
  if (!found) return session::Fail("transparency", found.error());
  options_.cell = *found;
  options_.command_line = invocation.command_line;
  return studies::RunTransparency(options_);
}

}  // namespace

void AddTransparencyCommand(CLI::App& app, Subcommands& all) {
  all.push_back(std::make_unique<TransparencyCommand>(app));
}

}  // namespace osteon::app
