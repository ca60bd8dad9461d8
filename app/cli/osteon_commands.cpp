#include "app/cli/osteon_commands.h"

#include <fmt/format.h>

#include "app/cli/help/command_table.h"
#include "app/cli/usage/cell_file.h"
#include "app/cli/usage/command_line.h"
#include "app/cli/usage/usage.h"
#include "config/reading/config_file_tracker.h"
#include "session/process/exit_code.h"

namespace osteon::app {
namespace {

// Returns the app once its top is prepared: its subcommands take over the form of the help.
CLI::App& Prepared(CLI::App& app, std::filesystem::path& config_root) {
  PrepareTop(app, config_root);
  return app;
}

}  // namespace

OsteonCommands::OsteonCommands(CLI::App& app)
    : app_(Prepared(app, config_root_)),
      demo_(app),
      pack_and_failures_(app, {"pack", "failures"}),
      doctor_app_(
          app.add_subcommand("doctor", "checks what this machine can do, with a verdict for each item")),
      faults_app_(app.add_subcommand("faults",
                                     "lists the faults that stop the cell, and how to continue after each")),
      states_app_(
          app.add_subcommand("states", "lists the states of the cell and what leads from one to another")),
      bench_and_chart_(app, {"bench", "chart"}),
      cells_(app),
      guard_(app),
      simulate_(app),
      operator_(app),
      tell_(app),
      calibrate_(app, {"calibrate"}),
      new_cell_(app),
      schema_(app),
      capability_to_tune_(
          app, {"capability", "transparency", "identify", "plan", "surgical-plan", "assess", "tune"}),
      export_(app),
      replay_(app),
      report_(app),
      view_(app),
      regress_to_completion_(app, {"regress", "validate", "soak", "diff", "merge", "manual", "completion"}) {
  app.footer(
      "Packings, benchmarks, charts, failures, studies and the manual are a second program, which ./osteon "
      "builds when one of them is first asked for.\n\n" +
      LauncherFooter() +
      "Examples:\n  osteon demo\n  osteon demo --help\n  osteon run demo --simulated --seconds 10\n"
      "  osteon bench frame\n  osteon doctor");
  doctor_app_
      ->add_option("cell", doctor_cell_,
                   "also examine what this cell's file names: network card, ports, CAN, PLC; a name under "
                   "cells/, or a YAML file")
      ->type_name("CELL");
  doctor_app_->add_option("--port", doctor_.fri_port, "FRI port to try")
      ->check(PortNumber())
      ->capture_default_str();
  doctor_app_
      ->add_option(
          "--seconds", doctor_.seconds,
          "duration of the timer test, once with SCHED_FIFO and once without; a measurement takes hours")
      ->check(NumberWithin(0.1, 86400))
      ->capture_default_str();
  doctor_app_->add_option("--json", doctor_.json, "also write the checks there, as JSON")->type_name("FILE");
  doctor_app_->footer(
      "Exit code 1: the FRI port is taken, or something that the cell's file names is missing\n\n"
      "Examples:\n  osteon doctor\n  osteon doctor my_cell.yaml\n  osteon doctor --seconds 3600 --json "
      "doctor.json");

  faults_app_->add_option("--markdown", faults_.markdown, "write the page there, as docs/faults.md")
      ->type_name("FILE");
  faults_app_->add_option("--json", faults_.json, "also write the faults there, as JSON")->type_name("FILE");
  faults_app_->footer("Examples:\n  osteon faults\n  osteon faults --json faults.json");

  states_app_->add_option("--markdown", states_.markdown, "write the page there, as docs/states.md")
      ->type_name("FILE");
  states_app_->add_option("--json", states_.json, "also write the states there, as JSON")->type_name("FILE");
  states_app_->footer("Examples:\n  osteon states\n  osteon states --json states.json");
}

int OsteonCommands::Run(const std::string& command_line) {
  config::SetShippedFolder(config_root_);
  if (demo_.asked()) return demo_.Run(config_root_, command_line);
  if (cells_.asked()) return cells_.Run(config_root_, command_line);
  if (guard_.asked()) return guard_.Run(config_root_);
  if (simulate_.asked()) return simulate_.Run(config_root_);
  if (operator_.asked()) return operator_.Run();
  if (tell_.asked()) return tell_.Run();
  if (new_cell_.asked()) return new_cell_.Run(config_root_);
  if (schema_.asked()) return schema_.Run(config_root_);
  if (export_.asked()) return export_.Run();
  if (replay_.asked()) return replay_.Run(config_root_);
  if (report_.asked()) return report_.Run(command_line);
  if (view_.asked()) return view_.Run();
  if (*states_app_) return RunStates(states_);
  if (*faults_app_) return RunFaults(faults_);
  if (*doctor_app_) return RunDoctor();
  fmt::print("{}", app_.help());
  return 0;
}

int OsteonCommands::RunDoctor() {
  if (!doctor_cell_.empty()) {
    const auto cell = FindCell(config_root_, doctor_cell_);
    if (!cell) return session::Fail("doctor", cell.error());
    doctor_.cell = *cell;
  }
  return session::RunDoctor(doctor_);
}

}  // namespace osteon::app
