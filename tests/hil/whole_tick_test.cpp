// Tests the requirement that a tick neither allocates memory nor takes a lock, from the arrival of the
// datagram to the record in the ring.

#include <algorithm>
#include <array>
#include <numbers>
#include <span>

#include <gtest/gtest.h>

#include "base/latest_value.h"
#include "control/loop/servo_loop.h"
#include "hil/simulated_cell.h"
#include "io/fri/fri_link.h"
#include "io/recording/recorder.h"
#include "test_client.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/io/net/loopback_socket.h"
#include "tests/io/temporary_folder.h"

namespace osteon::hil {
namespace {

using control::Phase;

// The socket of the simulated arm, connected to the client's port.
class ArmSocket : public io::test::LoopbackSocket {
 public:
  explicit ArmSocket(std::uint16_t client_port) { Connect(client_port); }

  // Passes the answers that wait in the socket to the cell.
  void DeliverAnswers(SimulatedCell& cell) const {
    while (const auto answer = Receive()) cell.Receive(*answer);
  }
};

// Parameters of a cell with a cup directly below the tool, and of the servo loop for this cell. The test adds
// the cup's bottom as a plane to the contact model.
struct CellSetup {
  CellSetup() {
    params.arm = kinematics::Iiwa14();
    params.q_start = {0.1, 0.5, 0.05, -1.4, 0.1, 0.9, 0.2};
    Pose X_FT = Pose::Identity();
    X_FT.translation().z() = 0.2;
    params.X_FT = X_FT;
    X_WT = arm.FlangePose(Eigen::Map<const kinematics::JointVector>(params.q_start.data())) * X_FT;
  }
  [[nodiscard]] HandScript Script() const {
    Pose X_WC = X_WT;
    X_WC.linear() = X_WT.linear() * ExpRotation({std::numbers::pi, 0.0, 0.0}).transpose();
    X_WC.translation() = X_WT * Vector3(0.0, 0.0, 0.040 - 0.025);
    return MakeReamingScript({.X_WC = X_WC, .seconds = 2.0});
  }
  [[nodiscard]] control::ServoParams Servo() const {
    control::ServoParams servo;
    servo.joints.limits = arm.params().limits;
    servo.workspace.sphere_center_W_m = X_WT.translation();
    servo.workspace.sphere_radius_m = 0.2;
    servo.workspace.plane_offset_m = -2.0;
    return servo;
  }

  kinematics::LbrArm arm{kinematics::Iiwa14()};
  SimulatedCellParams params;
  Pose X_WT;
};

// The servo loop in position mode, with an arm of each family of FRI versions.
class WholeTick : public ::testing::TestWithParam<io::FriVersion> {};

TEST_P(WholeTick, NeitherAllocatesNorLocksFromDatagramToRecord) {
  CellSetup setup;
  setup.params.fri.version = GetParam();
  SimulatedCell cell(setup.params, setup.Script());
  control::ServoLoop loop(
      setup.Servo(), setup.arm, Pose::Identity(), setup.params.X_FT,
      setup.arm.ArmAngle(Eigen::Map<const kinematics::JointVector>(setup.params.q_start.data())));
  auto link = io::FriLink::Open({.port = 0, .session = {.version = GetParam()}});
  ASSERT_TRUE(link) << link.error();
  const ArmSocket arm((*link)->port());
  const io::test::TemporaryFolder folder;
  auto recorder = io::Recorder::Open({.path = folder.path() / "tick.mcap", .writer_thread = false}, {});
  ASSERT_TRUE(recorder) << recorder.error();

  rt::LatestValue<simulation::ContactModel> models;
  rt::LatestValue<simulation::ToolCommand> commands;
  rt::LatestValue<control::ForceReading> sensor;
  control::ArmState state;
  control::ArmCommand command;
  const Vector3 feed_W = setup.X_WT.linear().col(2);
  std::array<int, 4> ticks_in_phase{};
  double peak_N = 0.0;
  for (int tick = 0; tick < 3500 && loop.phase() != Phase::kStopped; ++tick) {
    // first the arm and the simulation, which may allocate
    const rt::Nanoseconds now =
        (tick + 1) * rt::kMillisecond;  // virtual time: the test does not wait for a clock
    arm.Send(cell.Step(now));
    sensor.Store(cell.force());
    const simulation::ToolCommand wanted = commands.Load();
    if (tick % 2 == 0 && wanted.stamp > 0) {
      simulation::ContactModel model;
      model.frame = static_cast<std::uint64_t>(tick + 1);
      model.pose_stamp = wanted.stamp;
      model.contact_count = 1;
      model.contacts[0].p_W_m = Vector3(setup.X_WT * Vector3(0.0, 0.0, 0.03));
      model.contacts[0].n_W = Vector3(-feed_W);
      model.contacts[0].stiffness_N_per_m = 20e3;
      models.Store(model);
    }
    if (tick == 3000) loop.RequestStop();

    // then the tick, which must not allocate
    rt::CheckedNoAllocScope no_alloc;
    const control::ReceiveResult received = (*link)->Receive(state, rt::MonotonicNow() + rt::kSecond);
    const control::TickRecord record = loop.Tick({.state = state,
                                                  .received = received,
                                                  .readings = {.force = sensor.Load()},
                                                  .model = models.Load(),
                                                  .now = now},
                                                 command);
    const bool answered = (*link)->Send(command);
    commands.Store(loop.tool_command());
    const bool recorded = (*recorder)->Push(record);
    no_alloc.End();

    ASSERT_EQ(received, control::ReceiveResult::kOk);
    ASSERT_TRUE(answered && recorded);
    ++ticks_in_phase[static_cast<std::size_t>(record.phase)];
    peak_N = std::max(peak_N, Vector3(record.F_coupling_T_W.f).norm());
    arm.DeliverAnswers(cell);
    if (tick % 1000 == 0) (*recorder)->Drain();
  }
  EXPECT_GT(ticks_in_phase[static_cast<std::size_t>(Phase::kWaiting)], 100);
  EXPECT_GT(ticks_in_phase[static_cast<std::size_t>(Phase::kHaptic)], 2000);
  EXPECT_GT(peak_N, 20.0) << "the bone was felt";
  EXPECT_EQ(loop.faults().bits(), 0u);
  EXPECT_EQ(loop.phase(), Phase::kStopped);
  EXPECT_EQ(cell.state().counters.lost, 0u);
}

INSTANTIATE_TEST_SUITE_P(Families, WholeTick,
                         ::testing::Values(io::FriVersion::k1_15, io::FriVersion::k2_5,
                                           io::FriVersion::k2_7));

// The FRI link without the servo loop, in every version and command mode, from the first message to the
// active session and through an emergency stop.
TEST(LinkTick, NeitherAllocatesNorLocksInAnyVersionAndMode) {
  using control::CommandMode;
  using control::ControlMode;
  for (const io::FriVersion version : io::kFriVersions)
    for (const auto& [mode, needs] : {std::pair{CommandMode::kPosition, ControlMode::kPosition},
                                      {CommandMode::kWrench, ControlMode::kCartesianImpedance},
                                      {CommandMode::kTorque, ControlMode::kJointImpedance}}) {
      SCOPED_TRACE(Name(version));
      CellSetup setup;
      setup.params.fri = {.version = version, .control_mode = needs, .command_mode = mode};
      setup.params.fri.request_after_good_cycles = setup.params.fri.activate_after_mirrored_answers = 5;
      SimulatedCell cell(setup.params, setup.Script());
      auto link = io::FriLink::Open({.port = 0, .session = {.version = version}});
      ASSERT_TRUE(link) << link.error();
      const ArmSocket arm((*link)->port());
      control::ArmState state;
      int active = 0, stopped = 0;
      for (int tick = 0; tick < 200; ++tick) {
        if (tick == 150) cell.server().EmergencyStop(1);
        arm.Send(cell.Step((tick + 1) * rt::kMillisecond));
        rt::CheckedNoAllocScope no_alloc;
        const control::ReceiveResult received = (*link)->Receive(state, rt::MonotonicNow() + rt::kSecond);
        control::ArmCommand command{.q = state.q_ipo, .activation = state.activation, .tau = state.tau_ext};
        command.F.t = Vector3(1, 2, 3);
        const bool answered = (*link)->Send(command);
        no_alloc.End();
        ASSERT_TRUE(received == control::ReceiveResult::kOk && answered);
        active += state.session == control::SessionState::kCommandingActive;
        stopped += state.safety_state != 0;
        arm.DeliverAnswers(cell);
      }
      EXPECT_GT(active, 50);
      EXPECT_GT(stopped, 40);
      EXPECT_EQ(cell.state().counters.lost + cell.state().counters.malformed, 0u);
    }
}

}  // namespace
}  // namespace osteon::hil
