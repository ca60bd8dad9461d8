#include <gtest/gtest.h>

#include "session/replay/replay.h"
#include "session/setup/recorded_config.h"
#include "tests/session/run/virtual_run.h"

// The shipped cell with the impedance law, in virtual time, over FRI's wrench and torque overlays.

namespace osteon::session {
namespace {

// @param torque  true: by FRI's torque overlay over joint impedance; false: by its wrench overlay
VirtualRun RunImpedance(double seconds, bool torque = false) {
  return RunInVirtualTime("thin_plate_impedance", seconds, [&](config::CellConfig& cell) {
    if (!torque) return;
    cell.simulated.fri.command_mode = control::CommandMode::kTorque;
    cell.simulated.fri.control_mode = control::ControlMode::kJointImpedance;
    cell.simulated.dynamic.stiffness_Nm_per_rad.setConstant(100.0);
  });
}

// Expects a complete run that cuts, without a fault, with overlays within the force limit.
void ExpectCompleteRun(const VirtualRun& finished) {
  EXPECT_EQ(finished.result.end, control::RunEnd::kSeconds);
  EXPECT_EQ(finished.result.faults.bits(), 0u);
  EXPECT_GT(finished.result.after.removed_volume_m3, 2e-9) << "it cuts";
  double rendered_N = 0.0, sent = 0.0;
  for (const control::TickRecord& tick : finished.recording.ticks) {
    rendered_N = std::max(rendered_N, Vector3(tick.F_coupling_T_W.f).norm());
    sent = std::max(sent, Vector3(tick.F_cmd_T.f).norm() +
                              Eigen::Map<const Eigen::VectorXd>(tick.tau_cmd.data(), 7).norm());
    ASSERT_LE(Vector3(tick.F_cmd_T.f).norm(), finished.recording.session.force_limit_N * (1.0 + 1e-12));
  }
  EXPECT_GT(rendered_N, 10.0);
  EXPECT_GT(sent, 5.0) << "as an overlay";
}

TEST(ImpedanceRun, DrillsOverTheWrenchOverlayWithoutAFaultAndReplaysBitForBit) {
  const VirtualRun finished = RunImpedance(6.0);
  ExpectCompleteRun(finished);
  const auto cell = LoadRecordedCell(finished.recording.session.config);
  ASSERT_TRUE(cell) << cell.error();
  const ReplayResult replay = Replay(finished.recording, *cell);
  EXPECT_TRUE(replay.identical) << replay.why_not;
  EXPECT_EQ(replay.ticks, finished.recording.ticks.size());
}

TEST(ImpedanceRun, DrillsOverTheTorqueOverlayWithoutAFault) { ExpectCompleteRun(RunImpedance(6.0, true)); }

}  // namespace
}  // namespace osteon::session
