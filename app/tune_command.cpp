#include "app/tune_command.h"

#include <fmt/format.h>

#include "app/cell_file.h"
#include "app/usage.h"

namespace osteon::app {

TuneCommand::TuneCommand(CLI::App& app)
    : sub_(app.add_subcommand("tune",
                              "maps where the loop is stable, and recommends gains for the virtual tool")) {
  TuneOptions& o = options_;
  sub_->add_option("cell", cell_, "a cell's YAML file, or a name under cells/")->required();
  sub_->add_option("--out", o.out, "folder for tune.html, .json, .csv, pictures and gains.yaml")
      ->capture_default_str();
  sub_->add_option("--json", o.json, "a further copy of tune.json");
  const auto stand = [](CLI::Option* option) {
    return option->group("What the gains have to stand")->capture_default_str();
  };
  stand(sub_->add_option("--margin", o.margin, "hand and wall may be so many times what they are")
            ->check(NumberWithin(1, 4)));
  stand(sub_->add_option("--worst-age-ms", o.worst_age_ms, "of a contact model's pose")
            ->check(NumberWithin(0, 60)));
  stand(sub_->add_option("--loss", o.loss, "share of the commands that never reach the arm")
            ->check(NumberWithin(0, 0.5)));
  stand(sub_->add_option("--jitter-ms", o.jitter_ms,
                         "by which a command may come later; 1, or the cell's period")
            ->check(NumberWithin(0, 30)));
  stand(sub_->add_option("--sensor-delay-ms", o.sensor_delay_ms,
                         "from what the hand exerts to what the loop is told; 1, or the cell's period")
            ->check(NumberWithin(0, 50)));
  stand(sub_->add_option("--grip", o.human_grip_N_per_m, "N/m: for hands up to it the tool has to stay light")
            ->check(NumberWithin(100, 50e3)));
  stand(sub_->add_option("--stiffest-grip", o.stiffest_grip_N_per_m,
                         "N/m: hands up to it are looked at as well")
            ->check(NumberWithin(100, 50e3)));
  sub_->add_option("--nodes", o.dampings, "dampings of the map")
      ->check(NumberWithin(3, 100))
      ->capture_default_str();
  sub_->add_option("--threads", o.threads, "the result does not depend on it")
      ->check(NumberWithin(1, 256))
      ->capture_default_str();
  sub_->footer(
      "Along one axis of the tool. What was computed stays in the folder: only what has changed is computed "
      "again.\n\nExamples:\n  osteon tune demo\n  osteon tune config/cells/demo.yaml --margin 1.5 --out "
      "my_gains\n"
      "  osteon run demo --simulated --gains tune/gains.yaml");
}

int TuneCommand::Run(const std::filesystem::path& config_root, const std::string& command_line) {
  options_.command_line = command_line;
  const auto found = FindCell(config_root, cell_);
  if (!found) {
    fmt::print(stderr, "osteon tune: {}\n", found.error());
    return 2;
  }
  options_.cell = *found;
  return RunTune(options_);
}

}  // namespace osteon::app
