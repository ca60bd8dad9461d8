#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "app/cli/files/export_command.h"
#include "app/cli/files/new_cell_command.h"
#include "app/cli/files/replay_command.h"
#include "app/cli/files/report_command.h"
#include "app/cli/files/schema_command.h"
#include "app/cli/files/view_command.h"
#include "app/cli/help/faults_command.h"
#include "app/cli/help/states_command.h"
#include "app/cli/run/cell_commands.h"
#include "app/cli/run/demo_command.h"
#include "app/cli/run/guard_command.h"
#include "app/cli/run/operator_commands.h"
#include "app/cli/run/simulate_command.h"
#include "app/cli/run/tell_command.h"
#include "app/cli/usage/study_commands.h"
#include "session/setup/doctor.h"

namespace osteon::app {

/// The subcommands of `osteon`: those that run a cell, and those that read or write its files. The help also
/// lists the subcommands of osteon-studies, the second executable; `osteon` hands them over to it.
class OsteonCommands {
 public:
  /// @param app  made with kName and kDescription; must outlive this object
  explicit OsteonCommands(CLI::App& app);

  static constexpr const char* kName = "osteon";
  static constexpr const char* kDescription =
      "haptic controller and cutting simulation for a hip-reaming robot cell";

  /// Runs the subcommand that was parsed; without one prints the help. @returns the process's exit code.
  [[nodiscard]] int Run(const std::string& command_line);

 private:
  [[nodiscard]] int RunDoctor();

  std::filesystem::path config_root_;
  CLI::App& app_;
  session::DoctorOptions doctor_;
  std::string doctor_cell_;
  FaultsOptions faults_;
  StatesOptions states_;
  // Each constructor adds its subcommands to the help, so the order of these members is the help's order.
  DemoCommand demo_;
  AnnouncedStudies pack_and_failures_;
  CLI::App *doctor_app_, *faults_app_, *states_app_;
  AnnouncedStudies bench_and_chart_;
  CellCommands cells_;
  GuardCommand guard_;
  SimulateCommand simulate_;
  OperatorCommands operator_;
  TellCommand tell_;
  AnnouncedStudies calibrate_;
  NewCellCommand new_cell_;
  SchemaCommand schema_;
  AnnouncedStudies capability_to_tune_;
  ExportCommand export_;
  ReplayCommand replay_;
  ReportCommand report_;
  ViewCommand view_;
  AnnouncedStudies regress_to_completion_;
};

}  // namespace osteon::app
