#include "studies/identify/excited_run.h"

#include <cmath>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "io/recording/recording_reader.h"
#include "session/setup/cell_setup.h"
#include "studies/identify/identify_estimate.h"
#include "tests/temporary_path.h"

// Identifies the demo cell's simulated arm through the real servo loop and devices in virtual time: FRI in
// memory, a sensor on CAN, a PLC. Two draws of two periods each, of which 16 s count.

namespace osteon::studies {
namespace {

namespace fs = std::filesystem;

const fs::path kDemo = fs::path(OSTEON_SOURCE_DIR) / "config/cells/demo.yaml";
constexpr ExcitationRequest kShort{
    .axis = 'z', .peak_speed_m_per_s = 0.05, .seed = 1, .draws = 2, .periods = 2};

session::CellSetup PrepareDemoCell() {
  auto setup = session::PrepareCell(kDemo, std::nullopt);
  EXPECT_TRUE(setup) << (setup ? "" : setup.error());
  return std::move(*setup);
}

TEST(ExcitedRun, IdentifiesTheSimulatedArmAndItsSensor) {
  const session::CellSetup setup = PrepareDemoCell();
  const fs::path file = TemporaryPath("free_z.mcap");
  const auto run = RunExcited(setup, {.request = kShort, .recording = file});
  ASSERT_TRUE(run) << run.error();
  IdentifyResult result = EmptyResult("demo", setup.config);
  const auto added = AddRecording(file, setup.config, result);
  ASSERT_TRUE(added) << added.error();
  ASSERT_TRUE(result.refused.empty()) << result.refused.front().what;
  ASSERT_EQ(result.axes.size(), 1u);
  const AxisResult& axis = result.axes.front();
  const hil::ServoArmParams& truth = setup.config.simulated.servo;
  EXPECT_NEAR(axis.fit.bandwidth_hz.value, truth.bandwidth_hz, 0.005 * truth.bandwidth_hz);
  EXPECT_NEAR(axis.fit.damping_ratio.value, truth.damping_ratio, 0.005);
  EXPECT_NEAR(axis.fit.dead_time_s.value, 1e-3 * truth.dead_cycles, 0.02e-3);
  ASSERT_TRUE(axis.tool) << axis.no_tool;
  EXPECT_NEAR(axis.tool->mass_kg.value, result.tool_mass_kg, 0.01 * result.tool_mass_kg);
  EXPECT_GT(axis.tool->delay_s.value, 0.0);
  EXPECT_LT(axis.tool->delay_s.value, 5e-3);

  // the loop was paused throughout: its own command stood still while the excitation moved the arm
  const auto recording = io::ReadRecording(file);
  ASSERT_TRUE(recording);
  const auto excited = ExcitedAxisOf(setup.config, kShort);
  const auto samples = SamplesOf(recording->ticks, *excited);
  ASSERT_TRUE(samples);
  EXPECT_EQ(samples->lost_answers + samples->lost_messages, 0u);
  double greatest_m = 0.0;
  for (const ExcitedSample& sample : samples->run.samples)
    greatest_m = std::max(greatest_m, std::abs(sample.y_m));
  EXPECT_GT(greatest_m, 1e-3);
  EXPECT_LT(greatest_m, 5e-3);
}

TEST(ExcitedRun, LostMessagesAndAnswersAreCountedAndDoNoHarm) {
  session::CellSetup setup = PrepareDemoCell();
  setup.config.injections.injections = {
      {.wire = hil::Wire::kArm, .direction = hil::Direction::kBoth, .faults = {.loss = 0.01}}};
  const fs::path file = TemporaryPath("lossy_z.mcap");
  const auto run = RunExcited(setup, {.request = kShort, .recording = file});
  ASSERT_TRUE(run) << run.error();
  IdentifyResult result = EmptyResult("demo", setup.config);
  ASSERT_TRUE(AddRecording(file, setup.config, result));
  ASSERT_EQ(result.axes.size(), 1u) << (result.refused.empty() ? "" : result.refused.front().what);
  const AxisResult& axis = result.axes.front();
  EXPECT_GT(axis.samples.lost_messages, 50u);
  EXPECT_GT(axis.samples.lost_answers, 50u);
  const hil::ServoArmParams& truth = setup.config.simulated.servo;
  EXPECT_NEAR(axis.fit.bandwidth_hz.value, truth.bandwidth_hz, 0.01 * truth.bandwidth_hz);
  EXPECT_NEAR(axis.fit.dead_time_s.value, 1e-3 * truth.dead_cycles, 0.05e-3);
}

TEST(ExcitedRun, FindsTheHandThatHoldsTheHandle) {
  const session::CellSetup setup = PrepareDemoCell();
  const fs::path file = TemporaryPath("held_x.mcap");
  ExcitationRequest request = kShort;
  request.axis = 'x';
  request.held = true;
  const auto run = RunExcited(setup, {.request = request, .recording = file});
  ASSERT_TRUE(run) << run.error();
  IdentifyResult result = EmptyResult("demo", setup.config);
  ASSERT_TRUE(AddRecording(file, setup.config, result));
  ASSERT_EQ(result.axes.size(), 1u);
  ASSERT_TRUE(result.axes.front().hand);
  const hil::OperatorHandParams& truth = setup.config.simulated.hand;
  EXPECT_NEAR(result.axes.front().hand->stiffness_N_per_m.value, truth.stiffness_N_per_m,
              0.1 * truth.stiffness_N_per_m);
}

// Excites the arm of an impedance cell with a wrench along an axis, and identifies its impedance.
IdentifyResult IdentifyOverlaid(const session::CellSetup& setup, char axis) {
  const fs::path file = TemporaryPath("overlay.mcap");
  ExcitationRequest request = kShort;
  request.axis = axis;
  request.overlay = true;
  const auto run = RunExcited(setup, {.request = request, .recording = file});
  EXPECT_TRUE(run) << run.error();
  IdentifyResult result = EmptyResult("thin_plate_impedance", setup.config);
  EXPECT_TRUE(AddRecording(file, setup.config, result));
  for (AxisResult& found : result.axes) JudgeAxis(found, result);
  return result;
}

session::CellSetup ImpedanceCell() {
  auto setup = session::PrepareCell(fs::path(OSTEON_SOURCE_DIR) / "config/cells/thin_plate_impedance.yaml",
                                    std::nullopt);
  EXPECT_TRUE(setup) << (setup ? "" : setup.error());
  return std::move(*setup);
}

// An arm with masses under Cartesian impedance, on its mount, is excited by a wrench. The fit starts from the
// cell's file, which differs from the arm.
TEST(ExcitedRun, IdentifiesTheArmsCartesianImpedance) {
  session::CellSetup setup = ImpedanceCell();
  setup.config.simulated.dynamic.friction_compensation = 1.0;
  for (const char axis : {'z', 'x'}) {
    const hil::DynamicArmParams truth = setup.config.simulated.dynamic;
    const IdentifyResult result = IdentifyOverlaid(setup, axis);
    ASSERT_TRUE(result.refused.empty()) << result.refused.front().what;
    ASSERT_EQ(result.axes.size(), 1u);
    const AxisResult& found = result.axes.front();
    ASSERT_TRUE(found.overlay);
    const ImpedanceFit& fit = *found.overlay;
    EXPECT_TRUE(found.model_holds) << axis << ": "
                                   << (result.warnings.empty() ? "" : result.warnings[0].what);
    EXPECT_NEAR(fit.translation_N_per_m.value, truth.stiffness_N_per_m, 0.01 * truth.stiffness_N_per_m)
        << axis;
    EXPECT_NEAR(fit.own_damping_ratio.value, truth.cartesian_damping_ratio, 0.01) << axis;
    EXPECT_NEAR(fit.mass_ratio.value, 1.0, 0.005) << axis;
    EXPECT_NEAR(fit.dead_time_s.value, 1e-3 * truth.dead_cycles, 0.03e-3) << axis;
    if (axis == 'x') {
      EXPECT_NEAR(fit.rotation_Nm_per_rad.value, truth.stiffness_Nm_per_rad_turn,
                  0.01 * truth.stiffness_Nm_per_rad_turn);
    }
    const config::IdentifiedCell written = ToIdentified(result);
    ASSERT_EQ(written.arm.size(), 1u);
    ASSERT_TRUE(written.arm[0].impedance);
    EXPECT_NEAR(written.arm[0].impedance->translation_N_per_m.value_or(0.0), truth.stiffness_N_per_m,
                0.01 * truth.stiffness_N_per_m);
    EXPECT_TRUE(written.arm[0].impedance->on_mount);
    EXPECT_NEAR(std::abs(written.response.at(0).lines.front().re), 1.0, 0.2);
  }
}

// Arm, sensor and PLC are connected by real sockets and run in wall time.
TEST(ExcitedRun, RecordsACellThatIsConnectedBySockets) {
  session::CellSetup setup = PrepareDemoCell();
  hil::QualityPolicyParams& quality =
      setup.config.simulated.fri.quality;  // a busy machine must cause no fault
  quality.end_after_lost_in_a_row = quality.end_after_lost_per_s = quality.good_max_lost_per_s = 1'000'000;
  safety::WatchdogParams& watchdog = setup.config.servo.watchdog;
  watchdog.arm_misses = 1000;
  watchdog.sensor_stop_s = watchdog.spindle_stop_s = watchdog.interlock_stop_s = 3.0;
  const fs::path file = TemporaryPath("wires.mcap");
  ExcitationRequest rest = kShort;
  rest.rest_s = 0.3;
  const auto run = RunExcited(setup, {.request = rest, .recording = file, .wall_time = true});
  ASSERT_TRUE(run) << run.error();
  const auto recording = io::ReadRecording(file);
  ASSERT_TRUE(recording);
  int paused = 0;
  for (const control::TickRecord& tick : recording->ticks)
    paused +=
        tick.cell_state == static_cast<std::uint8_t>(safety::CellState::kPaused) && tick.input.received == 0;
  EXPECT_GT(paused, 250) << "the arm stood in the loop's pause";
}

TEST(ExcitedRun, ARecordingOfAnotherCellIsRefused) {
  session::CellSetup setup = PrepareDemoCell();
  const fs::path file = TemporaryPath("rest.mcap");
  ExcitationRequest rest = kShort;
  rest.rest_s = 0.5;
  const auto run = RunExcited(setup, {.request = rest, .recording = file});
  ASSERT_TRUE(run) << run.error();
  const auto refusal = [&](const config::CellConfig& cell) {
    IdentifyResult result = EmptyResult("demo", cell);
    EXPECT_TRUE(AddRecording(file, cell, result));
    return result.refused.empty() ? "" : result.refused.front().what;
  };
  EXPECT_EQ(refusal(setup.config), "");
  config::CellConfig other = setup.config;
  other.robot.name = "another";
  EXPECT_NE(refusal(other).find("accepted another"), std::string::npos);
  other = setup.config;
  other.tool.tool.name = "broach";
  EXPECT_NE(refusal(other).find("accepted broach"), std::string::npos);
  other = setup.config;
  other.servo.period_s = 4e-3;
  EXPECT_NE(refusal(other).find("accepted 4 ms"), std::string::npos);
  other = setup.config;
  other.start.q[1] += 0.1;
  EXPECT_NE(refusal(other).find("differ by 0.100 rad"), std::string::npos);
}

TEST(ExcitedAxis, MovesTheApexOnlyAlongTheAxis) {
  const session::CellSetup setup = PrepareDemoCell();
  for (const char name : {'x', 'y', 'z'}) {
    ExcitationRequest request = kShort;
    request.axis = name;
    const auto axis = ExcitedAxisOf(setup.config, request);
    ASSERT_TRUE(axis) << axis.error();
    const Eigen::Map<const kinematics::JointVector> direction(axis->hold.direction.data());
    EXPECT_NEAR((axis->hold.J_W * direction - axis->hold.axis_W).norm(), 0.0, 1e-9);
    EXPECT_NEAR(axis->axis_S.norm(), 1.0, 1e-9);
    EXPECT_EQ(axis->hold.max_force_N, 30.0);
    request.held = true;
    EXPECT_EQ(ExcitedAxisOf(setup.config, request)->hold.max_force_N, 60.0);
  }
}

}  // namespace
}  // namespace osteon::studies
