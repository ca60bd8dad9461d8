#include "app/cli/osteon_commands.h"

#include <fmt/format.h>

#include "app/cli/help/command_table.h"
#include "app/cli/help/faults_command.h"
#include "app/cli/help/states_command.h"
#include "app/cli/subcommands.h"
#include "app/cli/usage/cell_file.h"
#include "app/cli/usage/command_line.h"
#include "app/cli/usage/study_commands.h"
#include "app/cli/usage/usage.h"
#include "config/reading/config_file_tracker.h"
#include "session/process/exit_code.h"
#include "session/setup/doctor.h"

namespace osteon::app {
namespace {

class DoctorCommand final : public Subcommand {
 public:
  explicit DoctorCommand(CLI::App& app)
      : Subcommand(
            app.add_subcommand("doctor", "checks what this machine can do, with a verdict for each item")) {
    sub_->add_option("cell", cell_,
                     "also examine what this cell's file names: network card, ports, CAN, PLC; a name under "
                     "cells/, or a YAML file")
        ->type_name("CELL");
    sub_->add_option("--port", options_.fri_port, "FRI port to try")
        ->check(PortNumber())
        ->capture_default_str();
    sub_->add_option(
            "--seconds", options_.seconds,
            "duration of the timer test, once with SCHED_FIFO and once without; a measurement takes hours")
        ->check(NumberWithin(0.1, 86400))
        ->capture_default_str();
    sub_->add_option("--json", options_.json, "also write the checks there, as JSON")->type_name("FILE");
    sub_->footer(
        "Exit code 1: the FRI port is taken, or something that the cell's file names is missing\n\n"
        "Examples:\n  osteon doctor\n  osteon doctor my_cell.yaml\n  osteon doctor --seconds 3600 --json "
        "doctor.json");
  }

  [[nodiscard]] int Run(const Invocation& invocation) override {
    if (!cell_.empty()) {
      const auto cell = FindCell(invocation.config_root, cell_);
      if (!cell) return session::Fail("doctor", cell.error());
      options_.cell = *cell;
    }
    return session::RunDoctor(options_);
  }

 private:
  session::DoctorOptions options_;
  std::string cell_;
};

class FaultsCommand final : public Subcommand {
 public:
  explicit FaultsCommand(CLI::App& app)
      : Subcommand(app.add_subcommand(
            "faults", "lists the faults that stop the cell, and how to continue after each")) {
    sub_->add_option("--markdown", options_.markdown, "write the page there, as docs/faults.md")
        ->type_name("FILE");
    sub_->add_option("--json", options_.json, "also write the faults there, as JSON")->type_name("FILE");
    sub_->footer("Examples:\n  osteon faults\n  osteon faults --json faults.json");
  }
  [[nodiscard]] int Run(const Invocation&) override { return RunFaults(options_); }

 private:
  FaultsOptions options_;
};

class StatesCommand final : public Subcommand {
 public:
  explicit StatesCommand(CLI::App& app)
      : Subcommand(
            app.add_subcommand("states", "lists the states of the cell and what leads from one to another")) {
    sub_->add_option("--markdown", options_.markdown, "write the page there, as docs/states.md")
        ->type_name("FILE");
    sub_->add_option("--json", options_.json, "also write the states there, as JSON")->type_name("FILE");
    sub_->footer("Examples:\n  osteon states\n  osteon states --json states.json");
  }
  [[nodiscard]] int Run(const Invocation&) override { return RunStates(options_); }

 private:
  StatesOptions options_;
};

}  // namespace

OsteonCommands::OsteonCommands(CLI::App& app) : app_(app) {
  PrepareTop(app, config_root_);  // first, since subcommands copy the help's formatter
  AddDemoCommand(app, all_);
  AnnounceStudies(app, {"pack", "failures"});
  all_.push_back(std::make_unique<DoctorCommand>(app));
  all_.push_back(std::make_unique<FaultsCommand>(app));
  all_.push_back(std::make_unique<StatesCommand>(app));
  AnnounceStudies(app, {"bench", "chart"});
  AddCellCommands(app, all_);
  AddGuardCommand(app, all_);
  AddSimulateCommand(app, all_);
  AddOperatorCommands(app, all_);
  AddTellCommand(app, all_);
  AnnounceStudies(app, {"calibrate"});
  AddNewCellCommand(app, all_);
  AddSchemaCommand(app, all_);
  AnnounceStudies(app, {"capability", "transparency", "identify", "plan", "surgical-plan", "assess", "tune"});
  AddExportCommand(app, all_);
  AddReplayCommand(app, all_);
  AddReportCommand(app, all_);
  AddViewCommand(app, all_);
  AnnounceStudies(app, {"regress", "validate", "soak", "diff", "merge", "manual", "completion"});
  app.footer(
      "Packings, benchmarks, charts, failures, studies and the manual are a second program, which ./osteon "
      "builds when one of them is first asked for.\n\n" +
      LauncherFooter() +
      "Examples:\n  osteon demo\n  osteon demo --help\n  osteon run demo --simulated --seconds 10\n"
      "  osteon bench frame\n  osteon doctor");
}

int OsteonCommands::Run(const std::string& command_line) {
  config::SetShippedFolder(config_root_);
  if (const auto code =
          RunAsked(all_, {.config_root = config_root_, .command_line = command_line, .words = {}}))
    return *code;
  fmt::print("{}", app_.help());
  return 0;
}

}  // namespace osteon::app
