#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "session/guard/guard.h"
#include "session/setup/config_checksum.h"
#include "tests/session/run/virtual_run.h"

// The guard must pass every command of an ordinary run. It gets the arm's messages and the controller's
// answers from recordings of the shipped cells in virtual time.

namespace osteon::session {
namespace {

using control::SessionState;

// The answer that the link sends in a tick. Like FriSession's answer, it repeats the arm's own position until
// the arm accepts commands and the loop has named the arm's activation.
safety::GuardCommand AnswerOf(const control::TickRecord& tick) {
  const control::TickInput& in = tick.input;
  const bool mirrors = tick.session_state != static_cast<std::uint8_t>(SessionState::kCommandingActive) ||
                       tick.activation_cmd != in.activation;
  safety::GuardCommand command{
      .sequence = in.sequence, .reflected = in.sequence, .q = in.has_ipo && mirrors ? in.q_ipo : tick.q_cmd};
  const Vector3 f(tick.F_cmd_T.f), t(tick.F_cmd_T.t);
  if (in.command_mode == static_cast<std::uint8_t>(control::CommandMode::kWrench))
    command.wrench = {f.x(), f.y(), f.z(), t.z(), t.y(), t.x()};
  if (in.command_mode == static_cast<std::uint8_t>(control::CommandMode::kTorque)) command.tau = tick.tau_cmd;
  return command;
}

safety::GuardSession SessionOf(std::uint8_t state) {
  if (state == static_cast<std::uint8_t>(SessionState::kCommandingActive))
    return safety::GuardSession::kActive;
  return state == static_cast<std::uint8_t>(SessionState::kCommandingWait)
             ? safety::GuardSession::kWaiting
             : safety::GuardSession::kMonitoring;
}

// Sends every tick of a recording through the guard of the cell `name`, and expects that all pass.
// @param margin  share by which the guard's limits exceed the cell's
void ExpectAllPasses(const std::string& name, const VirtualRun& finished, double margin) {
  config::CellConfig cell = config::LoadCell(OSTEON_SOURCE_DIR "/config/cells/" + name + ".yaml");
  cell.guard = config::GuardConfig{.host = "127.0.0.1", .port = 30209, .margin = margin};
  safety::GuardMonitor monitor(GuardParamsOf(cell));
  std::uint64_t answers = 0;
  for (const control::TickRecord& tick : finished.recording.ticks) {
    const control::TickInput& in = tick.input;
    if (in.received != 0 || tick.session_state == 0) continue;
    safety::GuardArmMessage message{.sequence = in.sequence,
                                    .session = SessionOf(tick.session_state),
                                    .q_meas = tick.q_meas,
                                    .tau_ext = in.tau_ext,
                                    .compliant = cell.servo.law == control::Law::kImpedance};
    if (in.has_ipo) message.q_ipo = in.q_ipo;
    ASSERT_EQ(monitor.OnArmMessage(message, in.now), safety::GuardDecision::kPass);
    ASSERT_EQ(monitor.OnCommand(AnswerOf(tick), in.now), safety::GuardDecision::kPass)
        << name << ", tick " << tick.tick << ": " << safety::Describe(monitor.reason());
    monitor.CheckSilence(in.now);
    ++answers;
  }
  EXPECT_GT(answers, 1000u);
  EXPECT_TRUE(monitor.permits()) << safety::Describe(monitor.reason());
  EXPECT_EQ(monitor.counters().withheld + monitor.counters().late + monitor.counters().duplicate, 0u);
}

TEST(GuardRun, TheWholeDemoPasses) {
  const VirtualRun finished = RunInVirtualTime("demo", 10.0, [](config::CellConfig&) {});
  EXPECT_EQ(finished.summary.ended, "completed");
  ExpectAllPasses("demo", finished, 0.25);
}

TEST(GuardRun, TheOtherShippedCellsPass) {
  for (const char* name : {"molar", "femoral_canal", "thin_plate", "sawbone_block", "thin_plate_impedance"}) {
    SCOPED_TRACE(name);
    const VirtualRun finished = RunInVirtualTime(name, 4.0, [](config::CellConfig&) {});
    EXPECT_TRUE(finished.summary.faults.empty());
    ExpectAllPasses(name, finished, 0.25);
  }
}

TEST(GuardRun, ATorqueOverlayPasses) {
  const VirtualRun finished = RunInVirtualTime("thin_plate_impedance", 4.0, [](config::CellConfig& cell) {
    cell.simulated.fri.command_mode = control::CommandMode::kTorque;
    cell.simulated.fri.control_mode = control::ControlMode::kJointImpedance;
    cell.simulated.dynamic.stiffness_Nm_per_rad.setConstant(100.0);
  });
  ExpectAllPasses("thin_plate_impedance", finished, 0.25);
}

// Compliance moves the tool's head or the bone. The guard computes the poses of a rigid tool, so compliance
// must not make it stop the arm.
TEST(GuardRun, CellsWithACompliantToolOrBonePass) {
  for (const char* name : {"long_drill", "cartilage_cup", "pelvis_mount"}) {
    SCOPED_TRACE(name);
    const VirtualRun finished = RunInVirtualTime(name, 3.0, [](config::CellConfig&) {});
    EXPECT_TRUE(finished.summary.faults.empty());
    EXPECT_TRUE(finished.recording.ticks.back().compliance.present);
    ExpectAllPasses(name, finished, 0.25);
  }
}

// Under the impedance law the controller commands a wrench; the bone stands on a soft mount.
TEST(GuardRun, AWrenchOverlayOnABoneThatMovesPasses) {
  double moved_m = 0.0;
  const VirtualRun finished = RunInVirtualTime("thin_plate_impedance", 3.0, [](config::CellConfig& cell) {
    control::BoneMountParams mount;
    mount.p_WMo_m = cell.X_WG * Vector3(0.0, 0.0, -0.05);
    cell.servo.compliance.mount = mount;
  });
  for (const control::TickRecord& tick : finished.recording.ticks)
    moved_m = std::max(moved_m, Vector3(tick.compliance.mount_m).norm());
  EXPECT_GT(moved_m, 50e-6);
  EXPECT_TRUE(finished.summary.faults.empty());
  ExpectAllPasses("thin_plate_impedance", finished, 0.25);
}

// The drill's permitted thrust is only 20 N. The loop detects the deflection and brakes, and the guard must
// pass the commands that brake.
TEST(GuardRun, TheLoopsOwnStopForATooLargeDeflectionPasses) {
  const VirtualRun finished = RunInVirtualTime(
      "long_drill", 4.0, [](config::CellConfig& cell) { cell.servo.compliance.tool->max_thrust_N = 20.0; });
  ASSERT_FALSE(finished.summary.faults.empty());
  EXPECT_NE(finished.summary.faults.front().name.find("deflection"), std::string::npos)
      << finished.summary.faults.front().name;
  ExpectAllPasses("long_drill", finished, 0.25);
}

// The arm starts outside the workspace and moves along a joint path to its start.
TEST(GuardRun, ThePathToTheStartFromOutsideTheWorkspacePasses) {
  const VirtualRun finished = RunInVirtualTime("thin_plate", 2.0, [](config::CellConfig& cell) {
    cell.simulated.q_start[0] += 0.3;
    cell.simulated.q_start[1] -= 0.15;
  });
  EXPECT_TRUE(finished.summary.faults.empty());
  ExpectAllPasses("thin_plate", finished, 0.25);
}

TEST(ConfigChecksum, DependsOnNamesAndContentsButNotOnFoldersOrderOrGains) {
  io::ConfigSource source;
  source.files = {{.name = "cells/a.yaml", .content = "x: 1\n"}, {.name = "robots/b.yaml", .content = "y"}};
  source.cell_file = "cells/a.yaml";
  const std::string sum = ConfigChecksum(source);
  EXPECT_EQ(sum.size(), 16u);
  io::ConfigSource elsewhere = source;
  std::swap(elsewhere.files[0], elsewhere.files[1]);
  for (io::ConfigFile& file : elsewhere.files) file.name = "other/" + file.name;
  elsewhere.files.push_back({.name = "g.yaml", .content = "mass"});
  elsewhere.gains_file = "g.yaml";
  EXPECT_EQ(ConfigChecksum(elsewhere), sum);
  for (const auto& change : {+[](io::ConfigSource& s) { s.files[0].content[0] = 'z'; },
                             +[](io::ConfigSource& s) { s.files[0].name = "cells/c.yaml"; },
                             +[](io::ConfigSource& s) { s.files.pop_back(); },
                             +[](io::ConfigSource& s) { s.files.push_back({.name = "d", .content = ""}); }}) {
    io::ConfigSource other = source;
    change(other);
    EXPECT_NE(ConfigChecksum(other), sum);
  }
  // FNV-1a of 64 bits, computed independently: empty input gives the offset basis
  EXPECT_EQ(ConfigChecksum({}), "cbf29ce484222325");
}

}  // namespace
}  // namespace osteon::session
