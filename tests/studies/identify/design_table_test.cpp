#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "control/excitation/excitation_path.h"
#include "hil/arm/servo_arm.h"
#include "session/setup/cell_setup.h"
#include "studies/identify/excited_run.h"
#include "studies/identify/identify.h"
#include "studies/identify/identify_estimate.h"
#include "studies/identify/identify_table.h"
#include "studies/identify/servo_fit.h"
#include "tests/temporary_path.h"

// Rows of the design's tables: short recordings, slow motions, jitter, and an arm with masses and friction.
// The design is the prototype that preceded this code; docs/identify.md compares both. Seeds are fixed and
// time is virtual.

namespace osteon::studies {
namespace {

constexpr double kPeriod_s = 1e-3;
const hil::ServoArmParams kDesignArm{.bandwidth_hz = 15.0, .damping_ratio = 1.0, .dead_cycles = 4.0};

// --- accuracy of short recordings and slow motions ---

// A row of the design's table: twice the standard deviation of the lag [ms], and those of the least drag and
// of the stiffest wall as shares of their values.
struct RecordingRow {
  SyntheticRun run;
  double lag_two_sd_ms, drag_two_sd, wall_two_sd;
};

class DesignTable : public testing::TestWithParam<RecordingRow> {};

TEST_P(DesignTable, EstimatesLagDragAndWallAsAccuratelyAsTheDesign) {
  const RecordingRow& row = GetParam();
  const TableRow found = IdentifyRow(row.run, {.arm = kDesignArm, .seeds = 6});
  EXPECT_EQ(found.failed, 0);
  // six seeds give the standard deviation to a factor of about two
  EXPECT_LT(found.lag_ms.two_sd, 2.0 * row.lag_two_sd_ms);
  EXPECT_GT(found.lag_ms.two_sd, 0.3 * row.lag_two_sd_ms);
  EXPECT_NEAR(found.lag_ms.mean, found.lag_ms.truth, row.lag_two_sd_ms);
  const TableFigure &drag = found.least_drag_Ns_per_m, &wall = found.greatest_wall_N_per_m;
  EXPECT_NEAR(drag.mean, drag.truth, row.drag_two_sd * drag.truth);
  EXPECT_LT(drag.two_sd, 2.0 * row.drag_two_sd * drag.truth);
  EXPECT_NEAR(wall.mean, wall.truth, row.wall_two_sd * wall.truth);
  EXPECT_LT(wall.two_sd, 2.5 * row.wall_two_sd * wall.truth);
}

INSTANTIATE_TEST_SUITE_P(
    Rows, DesignTable,
    testing::Values(RecordingRow{{.name = "short_24_s", .draws = 2, .periods = 2}, 0.017, 0.001, 0.05},
                    RecordingRow{{.name = "slow_20_mm_per_s", .peak_m_per_s = 0.02}, 0.023, 0.002, 0.029},
                    RecordingRow{{.name = "slow_5_mm_per_s", .peak_m_per_s = 0.005}, 0.09, 0.006, 0.12}),
    [](const auto& row) { return row.param.run.name; });

// Commands arrive late by a random part of the period: the estimated dead time must grow by the mean delay.
TEST(DesignTable, JitterAddsItsMeanToTheDeadTime) {
  constexpr int kFine =
      8;  // steps of the arm in a period: the most that the arm accepts at 4 ms of dead time
  control::ExcitationPath path({.seed = 100, .draws = 4, .periods = 3, .peak_speed_m_per_s = 0.05},
                               kPeriod_s);
  std::array<kinematics::JointLimits, 7> limits{};
  for (kinematics::JointLimits& limit : limits) limit.velocity_rad_per_s = 1e3;
  hil::ServoArmParams fine = kDesignArm;
  fine.dead_cycles *= kFine;
  hil::ServoArm arm(fine, limits, kPeriod_s / kFine, kinematics::JointVector::Zero());
  std::mt19937_64 random(1);
  std::uniform_int_distribution<int> late(0, kFine - 1);
  std::normal_distribution<double> noise(0.0, 10e-6);
  ExcitedRun run{.period_s = kPeriod_s, .samples = {}};
  double before_m = 0.0;
  for (;;) {
    const control::ExcitationStep step = path.Step(true);
    if (step.part == control::ExcitationPart::kDone) break;
    run.samples.push_back({.seen = true,
                           .u_m = step.x_m,
                           .y_m = arm.q()[0] + noise(random),
                           .counted = step.part == control::ExcitationPart::kCounted,
                           .draw = step.draw,
                           .period = step.period});
    const int arrives = late(random);
    for (int i = 0; i < kFine; ++i)
      arm.Step(kinematics::JointVector::Constant(i < arrives ? before_m : step.x_m));
    before_m = step.x_m;
  }
  const auto response = MeasureResponse(run, Signal::kCommand, Signal::kPosition);
  ASSERT_TRUE(response) << response.error();
  const auto fit = FitServo(response->lines, kPeriod_s);
  ASSERT_TRUE(fit) << fit.error();
  const double mean_s = 0.5 * (kFine - 1) * kPeriod_s / kFine;
  EXPECT_NEAR(fit->dead_time_s.value, 4e-3 + mean_s, 0.06e-3) << "the design: 4.477 ms";
  EXPECT_NEAR(fit->bandwidth_hz.value, 15.0, 0.1);
  hil::ServoArmParams found = kDesignArm;
  found.dead_cycles = fit->dead_time_s.value / kPeriod_s;
  EXPECT_NEAR(GreatestWall(found, kPeriod_s), 0.85 * GreatestWall(kDesignArm, kPeriod_s),
              0.05 * GreatestWall(kDesignArm, kPeriod_s))
      << "the design: -17 %, of half a period";
}

// --- an arm with masses and friction ---

// Figures identified from one excited run.
struct MassesRun {
  double lag_s{0.0}, bandwidth_hz{0.0}, rms_m_per_s{0.0};
};

// Excites the demo's arm, simulated with masses, along z and identifies it.
MassesRun IdentifyWithMasses(double peak_m_per_s, bool friction) {
  const auto cell = std::filesystem::path(OSTEON_SOURCE_DIR) / "config/cells/demo.yaml";
  auto setup = session::PrepareCell(cell, std::nullopt);
  EXPECT_TRUE(setup) << setup.error();
  setup->config.simulated.level = hil::ArmLevel::kDynamic;
  setup->config.simulated.dynamic.mount.reset();
  if (!friction)
    for (auto& joint : setup->config.simulated.chain.joints) joint.friction = {};
  const std::filesystem::path file = TemporaryPath(
      "masses_" + std::to_string(std::lround(1e3 * peak_m_per_s)) + (friction ? "_f" : "_n") + ".mcap");
  const auto run = RunExcited(
      *setup,
      {.request = {.axis = 'z', .peak_speed_m_per_s = peak_m_per_s, .seed = 1, .draws = 2, .periods = 2},
       .recording = file});
  EXPECT_TRUE(run) << run.error();
  IdentifyResult result = EmptyResult("demo", setup->config);
  const auto added = AddRecording(file, setup->config, result);
  EXPECT_TRUE(added && result.axes.size() == 1u) << (added ? "" : added.error());
  const AxisResult& axis = result.axes.front();
  return {axis.fit.lag_s.value, axis.fit.bandwidth_hz.value, axis.rms_speed_m_per_s};
}

TEST(ArmWithMasses, FrictionMakesSlowMotionsLagMore) {
  const MassesRun slow = IdentifyWithMasses(0.01, true), fast = IdentifyWithMasses(0.05, true),
                  smooth = IdentifyWithMasses(0.05, false);
  std::printf("rms %.1f, %.1f mm/s: lag %.2f, %.2f ms; without friction %.2f ms, %.2f Hz\n",
              1e3 * slow.rms_m_per_s, 1e3 * fast.rms_m_per_s, 1e3 * slow.lag_s, 1e3 * fast.lag_s,
              1e3 * smooth.lag_s, smooth.bandwidth_hz);
  EXPECT_GT(slow.lag_s, 1.03 * fast.lag_s);
  EXPECT_GT(fast.lag_s, 1.02 * smooth.lag_s);
  EXPECT_NEAR(smooth.bandwidth_hz, 15.0, 0.03 * 15.0) << "3 % of error in the controller's masses";
}

// Excites the cell's arm along z, identifies it and judges the result.
IdentifyResult RunAndJudge(session::CellSetup& setup, double peak_m_per_s) {
  const std::filesystem::path file = TemporaryPath("judged.mcap");
  const auto run = RunExcited(
      setup,
      {.request = {.axis = 'z', .peak_speed_m_per_s = peak_m_per_s, .seed = 1, .draws = 2, .periods = 2},
       .recording = file});
  EXPECT_TRUE(run) << run.error();
  IdentifyResult result = EmptyResult("demo", setup.config);
  EXPECT_TRUE(AddRecording(file, setup.config, result));
  for (AxisResult& axis : result.axes) JudgeAxis(axis, result);
  return result;
}

session::CellSetup DemoWithMasses() {
  auto setup =
      session::PrepareCell(std::filesystem::path(OSTEON_SOURCE_DIR) / "config/cells/demo.yaml", std::nullopt);
  EXPECT_TRUE(setup) << setup.error();
  setup->config.simulated.level = hil::ArmLevel::kDynamic;
  setup->config.simulated.dynamic.mount.reset();
  return std::move(*setup);
}

// At a slow motion, joints that stick must be refused with advice. The friction is that of unloaded joints,
// fifteen times the cell's. (The design found "687 Hz, zeta 67" at 2 % of the joints' speed.)
TEST(DesignTable, JointsThatStickAtASlowMotionAreRefused) {
  session::CellSetup setup = DemoWithMasses();
  EXPECT_TRUE(RunAndJudge(setup, 0.05).refused.empty()) << "with the cell's friction, at 50 mm/s";
  for (auto& joint : setup.config.simulated.chain.joints) joint.friction.coulomb_Nm *= 15.0;
  const IdentifyResult slow = RunAndJudge(setup, 0.002);
  ASSERT_FALSE(slow.refused.empty());
  const bool told = std::ranges::any_of(slow.refused, [](const Finding& finding) {
    return finding.what.find("raise the speed") != std::string::npos;
  });
  EXPECT_TRUE(told) << slow.refused.front().what;
}

// A pedestal of 2 MN/m yields, which the encoders don't measure, so no servo model fits (in the design: 12.6
// Hz, chi^2 14). Only the measured response is written.
TEST(DesignTable, OnAFlexiblePedestalOnlyTheMeasuredResponseIsWritten) {
  session::CellSetup setup = DemoWithMasses();
  for (auto& joint : setup.config.simulated.chain.joints) joint.friction = {};
  setup.config.simulated.dynamic.mount = hil::FlexibleMountParams{.stiffness_N_per_m = 2e6};
  const IdentifyResult result = RunAndJudge(setup, 0.05);
  ASSERT_EQ(result.axes.size(), 1u);
  const AxisResult& axis = result.axes.front();
  std::printf("pedestal: %.2f Hz, damping %.2f, chi^2 %.1f\n", axis.fit.bandwidth_hz.value,
              axis.fit.damping_ratio.value, axis.fit.chi2);
  EXPECT_LT(axis.fit.bandwidth_hz.value, 14.5) << "the design: 12.6 Hz of 15.2";
  EXPECT_GT(axis.fit.chi2, 3.0) << "the design: 14";
  EXPECT_FALSE(axis.model_holds);
  const config::IdentifiedCell written = ToIdentified(result);
  EXPECT_TRUE(written.arm.empty());
  EXPECT_FALSE(written.response.empty());
}

}  // namespace
}  // namespace osteon::studies
