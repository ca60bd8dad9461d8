#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "app/cli/cell_commands.h"
#include "app/cli/demo_command.h"
#include "app/cli/export_command.h"
#include "app/cli/faults_command.h"
#include "app/cli/guard_command.h"
#include "app/cli/new_cell_command.h"
#include "app/cli/pack_command.h"
#include "app/cli/replay_command.h"
#include "app/cli/schema_command.h"
#include "app/cli/states_command.h"
#include "app/cli/study_commands.h"
#include "session/setup/doctor.h"

namespace osteon::app {

/// The subcommands of `osteon`: what runs a cell, and what reads or writes its files. Those of osteon-studies
/// are announced among them, in the order of the help.
class OsteonCommands {
 public:
  /// @param app  with the name and the description below; must outlive this object
  explicit OsteonCommands(CLI::App& app);

  static constexpr const char* kName = "osteon";
  static constexpr const char* kDescription =
      "haptic controller and cutting simulation for a hip-reaming robot cell";

  /// Runs the subcommand that was parsed; without one prints the help. @returns the process's exit code.
  [[nodiscard]] int Run(const std::string& command_line);

 private:
  std::filesystem::path config_root_;
  CLI::App& app_;
  DoctorOptions doctor_;
  FaultsOptions faults_;
  StatesOptions states_;
  // In the order of the help, in which their constructors add them.
  DemoCommand demo_;
  PackCommand pack_;
  AnnouncedStudies failures_;
  CLI::App *doctor_app_, *faults_app_, *states_app_;
  AnnouncedStudies bench_and_chart_;
  CellCommands cells_;
  GuardCommand guard_;
  AnnouncedStudies calibrate_;
  NewCellCommand new_cell_;
  SchemaCommand schema_;
  AnnouncedStudies capability_to_tune_;
  ExportCommand export_;
  ReplayCommand replay_;
  AnnouncedStudies regress_to_completion_;
};

}  // namespace osteon::app
