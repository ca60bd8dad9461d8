#pragma once

#include <filesystem>

#include <CLI/CLI.hpp>

#include "app/cli/studies/shard_option.h"
#include "studies/bench/bench_console.h"
#include "studies/bench/bench_frame.h"
#include "studies/bench/bench_kinematics.h"
#include "studies/bench/bench_simulate.h"
#include "studies/bench/bench_surface.h"
#include "studies/bench/bench_tick.h"
#include "studies/bench/bench_view.h"
#include "studies/charts/chart_compliance.h"
#include "studies/charts/chart_scaling.h"
#include "studies/charts/chart_speed_accuracy.h"

namespace osteon::app {

/// The subcommands that measure: `bench frame`, `bench kinematics`, `bench surface`, `bench tick`, `bench
/// console`, `bench view`, `bench simulate`, `chart scaling`, `chart speed-accuracy`, `chart compliance`.
class MeasureCommands {
 public:
  explicit MeasureCommands(CLI::App& app);

  /// Whether one of them was on the command line.
  [[nodiscard]] bool asked() const;
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::filesystem::path& config_root, const Invocation& invocation);

 private:
  studies::BenchFrameOptions frame_options_;  // before the members that point into it
  studies::BenchKinematicsOptions kinematics_options_;
  studies::BenchSurfaceOptions surface_options_;
  studies::BenchTickOptions tick_options_;
  studies::BenchConsoleOptions console_options_;
  studies::BenchViewOptions view_options_;
  studies::BenchSimulateOptions simulate_options_;
  studies::ScalingOptions scaling_options_;
  studies::SpeedAccuracyOptions accuracy_options_;
  studies::ComplianceChartOptions compliance_options_;
  CLI::App *bench_, *frame_, *kinematics_, *surface_, *tick_, *console_, *view_, *simulate_, *chart_,
      *scaling_, *accuracy_, *compliance_;
};

}  // namespace osteon::app
