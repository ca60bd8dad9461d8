#include "hil/simulated_cell.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "test_client.h"

// Tests a simulated cell with an LBR arm in virtual time: the hand, the force sensor, the power, and the
// motion of the arm.

namespace osteon::hil {
namespace {

using control::SessionState;
using kinematics::JointVector;

// An LBR iiwa 14 whose base and tool have general poses.
SimulatedCellParams CellParams() {
  SimulatedCellParams params;
  params.arm = kinematics::Iiwa14();
  Pose X_WB = Pose::Identity();
  X_WB.linear() = ExpRotation({0.0, 0.0, 0.8});
  X_WB.translation() = Vector3(0.1, 0.2, 0.3);
  params.X_WB = X_WB;
  Pose X_FT = Pose::Identity();
  X_FT.linear() = ExpRotation({0.0, 0.2, 0.0});
  X_FT.translation() = Vector3(0.02, -0.01, 0.18);
  params.X_FT = X_FT;
  params.q_start = {0.2, 0.6, -0.1, -1.3, 0.15, 0.9, 0.3};
  return params;
}

// Pose of the tool in W for joint angles q [rad].
Pose ToolPose(const SimulatedCellParams& params, const JointVector& q) {
  return Pose(params.X_WB) * kinematics::LbrArm(params.arm).FlangePose(q) * Pose(params.X_FT);
}

// A cup directly below the tool's start pose.
HandScript ScriptBelow(const SimulatedCellParams& params, double seconds) {
  const Pose X_WT = ToolPose(params, Eigen::Map<const JointVector>(params.q_start.data()));
  Pose X_WC;
  X_WC.linear() = X_WT.linear() * ExpRotation({std::numbers::pi, 0.0, 0.0}).transpose();
  X_WC.translation() = X_WT * Vector3(0.0, 0.0, 0.040 - 0.025);
  return MakeReamingScript({.X_WC = X_WC, .seconds = seconds});
}

// A client with a small admittance controller: M V' + D V = F_hand + F_wall. The joints follow from the
// closed-form inverse kinematics. The wall is a spring and damper (20 kN/m, 200 N s/m) below the height 0 on
// the cup's axis, and acts on the commanded pose.
class AdmittanceClient {
 public:
  AdmittanceClient(const SimulatedCellParams& params, const HandScript& script)
      : params_(params),
        arm_(params.arm),
        X_WC_(script.X_WC()),
        q_(Eigen::Map<const JointVector>(params.q_start.data())),
        X_WT_(ToolPose(params, q_)),
        arm_angle_(arm_.ArmAngle(q_)) {}

  // The answer to a message. Until the session is active, it repeats the joints of the message. Then it
  // contains the result of one period of the controller under the hand's wrench.
  Bytes Answer(std::span<const std::uint8_t> message, const Wrench& F_hand_T_W) {
    const auto state = static_cast<SessionState>(UintAt(message, {4, 1}));
    if (state != SessionState::kCommandingActive) return mirror_.Answer(message);
    const double T = 1e-3;
    const Vector3 n = X_WC_.linear().col(2);
    const double height_m = n.dot(X_WT_.translation() - X_WC_.translation()) + 0.025;
    Wrench F = F_hand_T_W;
    wall_N = height_m < 0.0 ? std::max(0.0, -20000.0 * height_m - 200.0 * n.dot(V_.v)) : 0.0;
    F.f += wall_N * n;
    V_.v = (V_.v + T / 3.0 * F.f) / (1.0 + T * 60.0 / 3.0);
    V_.w = (V_.w + T / 0.05 * F.t) / (1.0 + T * 2.0 / 0.05);
    X_WT_.translation() += T * V_.v;
    X_WT_.linear() = ExpRotation(T * V_.w) * X_WT_.linear();
    reached &=
        arm_.Inverse(Pose(params_.X_WB).inverse() * X_WT_ * Pose(params_.X_FT).inverse(), arm_angle_, q_, q_);
    return Command(++mirror_.sequence, static_cast<std::uint32_t>(UintAt(message, {1, 2})),
                   {q_.data(), q_.data() + 7});
  }

  double wall_N{0.0};  // the wall's force in the last cycle
  bool reached{true};  // the inverse kinematics has had a solution in every cycle

 private:
  SimulatedCellParams params_;
  kinematics::LbrArm arm_;
  Pose X_WC_;
  JointVector q_;
  Pose X_WT_;
  double arm_angle_;
  Twist V_;
  TestClient mirror_;
};

struct Outcome {
  Bytes bytes;  // all bytes that the cell has sent
  CellState end;
  double peak_axial_N{0.0}, wall_at_push_N{0.0}, end_height_m{0.0};
  bool reached{true};
};

// Runs the cell and the admittance client until the script, which lasts this long, is done.
Outcome RunCell(double seconds) {
  const SimulatedCellParams params = CellParams();
  const HandScript script = ScriptBelow(params, seconds);
  SimulatedCell cell(params, script);
  AdmittanceClient client(params, script);
  Outcome run;
  const Vector3 n = script.X_WC().linear().col(2);
  for (int k = 0; k < 60000 && !cell.state().script_done; ++k) {
    const auto message = cell.Step(k * rt::kMillisecond);
    run.bytes.insert(run.bytes.end(), message.begin(), message.end());
    cell.Receive(client.Answer(message, cell.state().F_hand_T_W));
    const Vector3 f = cell.state().F_hand_T_W.f;
    run.peak_axial_N = std::max(run.peak_axial_N, std::abs(n.dot(f)));
    if (std::abs(cell.state().cell_time_s - 0.5 * seconds) < 1e-6) run.wall_at_push_N = client.wall_N;
  }
  run.end = cell.state();
  run.end_height_m = n.dot(Vector3(run.end.X_WT_meas.p) - script.X_WC().translation()) + 0.025;
  run.reached = client.reached;
  return run;
}

// Tests the closed loop of session, hand, sensor, client and arm. The hand pushes with 120 N, so the wall
// must carry 120 N.
TEST(SimulatedCell, AHandsPushReachesTheWallThroughAnAdmittanceClient) {
  const Outcome run = RunCell(10.0);
  EXPECT_TRUE(run.end.script_done);
  EXPECT_TRUE(run.reached);
  EXPECT_EQ(run.end.session, SessionState::kCommandingActive) << Describe(run.end.stop);
  EXPECT_EQ(run.end.counters.lost, 0u);
  EXPECT_LE(run.peak_axial_N, 120.0 + 1e-9);
  EXPECT_NEAR(run.wall_at_push_N, 120.0, 0.5);
  EXPECT_NEAR(run.end_height_m, 0.030, 1e-3);  // the hand has retracted the tool
}

TEST(SimulatedCell, TwoRunsGiveTheSameBytes) {
  const Outcome a = RunCell(2.0), b = RunCell(2.0);
  ASSERT_GT(a.bytes.size(), 2000u * 400u);
  EXPECT_EQ(a.bytes, b.bytes);
  EXPECT_EQ(a.end.q_meas, b.end.q_meas);
}

TEST(SimulatedCell, TheHandHoldsOnlyWhileTheArmIsCommanded) {
  const SimulatedCellParams params = CellParams();
  SimulatedCell cell(params, ScriptBelow(params, 10.0));
  TestClient client;
  int active_cycles = 0;
  for (int k = 0; k < 1500; ++k) {
    const auto message = cell.Step(k * rt::kMillisecond);
    const bool active = cell.state().session == SessionState::kCommandingActive;
    active_cycles += active;
    EXPECT_NEAR(cell.state().cell_time_s, active_cycles * 1e-3, 1e-12);
    if (!active) {
      EXPECT_EQ(Vector3(cell.state().F_hand_T_W.f).norm(), 0.0);
    }
    EXPECT_EQ(cell.force().stamp, k * rt::kMillisecond);
    cell.Receive(client.Answer(message));
  }
  ASSERT_GT(active_cycles, 500);
  EXPECT_GT(Vector3(cell.state().F_hand_T_W.f).norm(),
            1.0);  // the arm stands still while the hand's target moves away
  for (int k = 0; k < 6; ++k) (void)cell.Step((1500 + k) * rt::kMillisecond);
  EXPECT_EQ(cell.state().stop.reason, StopReason::kLostInARow);
  EXPECT_EQ(Vector3(cell.state().F_hand_T_W.f).norm(), 0.0);
}

// The cell computes the sensor's load from the hand's wrench; the controller computes the hand's wrench from
// the load. Their code is independent, and the poses of tool and sensor are general.
TEST(SimulatedCell, TheControllerRecoversTheHandWrenchFromTheSensorsLoad) {
  SimulatedCellParams params = CellParams();
  Pose X_FS = Pose::Identity();
  X_FS.linear() = ExpRotation({0.3, -0.2, 0.9});
  X_FS.translation() << 0.01, -0.02, 0.035;
  params.sensor = {.X_FS = X_FS, .tool_mass_kg = 1.7, .tool_center_F_m = Vector3(0.02, 0.01, 0.09)};
  SimulatedCell cell(params, ScriptBelow(params, 1.0));
  TestClient client;
  const auto hand = [&] {
    const Pose X_WT = cell.state().X_WT_meas;
    return control::HandWrench(params.sensor, cell.force().F_S, X_WT * Pose(params.X_FT).inverse(),
                               X_WT.translation());
  };
  client.Answer(cell.Step(0));
  EXPECT_NEAR(Vector3(cell.force().F_S.f).norm(), 1.7 * 9.81, 1e-9) << "nobody holds it: the tool's weight";
  EXPECT_LT(hand().f.norm(), 1e-9);
  EXPECT_LT(hand().t.norm(), 1e-9);
  for (int k = 1; k < 5000 && cell.state().cell_time_s < 0.5; ++k)
    cell.Receive(client.Answer(cell.Step(k * rt::kMillisecond)));
  const Wrench exerted = cell.state().F_hand_T_W;
  ASSERT_GT(exerted.f.norm(), 10.0);
  EXPECT_LT((hand().f - exerted.f).norm(), 1e-9);
  EXPECT_LT((hand().t - exerted.t).norm(), 1e-9);
}

TEST(SimulatedCell, TheDrivesStopWithoutPowerAndReturnWithIt) {
  const SimulatedCellParams params = CellParams();
  SimulatedCell cell(params, ScriptBelow(params, 10.0));
  TestClient client;
  int now_ms = 0;
  const auto run = [&](int cycles) {
    for (int k = 0; k < cycles; ++k) cell.Receive(client.Answer(cell.Step(++now_ms * rt::kMillisecond)));
  };
  cell.SetPower(false);
  run(3000);
  EXPECT_FALSE(cell.state().active_once) << "never commanded without power";
  cell.SetPower(true);
  run(3000);
  ASSERT_EQ(cell.state().session, SessionState::kCommandingActive);
  EXPECT_EQ(cell.state().stop.reason, StopReason::kNone) << "what is acknowledged is over";
  cell.SetPower(false);
  run(2);
  EXPECT_NE(cell.state().session, SessionState::kCommandingActive);
  EXPECT_EQ(cell.state().stop.reason, StopReason::kPowerOff);
}

// A session whose quality is not GOOD within ten seconds is closed. If no client has ever answered, the
// program is started again. If a client has answered too rarely, it is not.
TEST(SimulatedCell, RestartsASessionUntilAClientAnswers) {
  const SimulatedCellParams params = CellParams();
  SimulatedCell cell(params, ScriptBelow(params, 10.0));
  TestClient client;
  int now_ms = 0;
  cell.SetPower(false);  // as with a PLC from which nobody has requested power
  for (int k = 0; k < 25'000; ++k) cell.Step(++now_ms * rt::kMillisecond);
  EXPECT_EQ(cell.state().session, SessionState::kMonitoringWait);
  EXPECT_EQ(cell.state().stop.reason, StopReason::kPowerOff) << "started again, still without power";
  cell.SetPower(true);
  const auto answer = [&](int cycles, int every) {
    for (int k = 0; k < cycles; ++k)
      if (const auto message = cell.Step(++now_ms * rt::kMillisecond); k % every == 0 && !message.empty())
        cell.Receive(client.Answer(message));
  };
  answer(3000, 1);
  EXPECT_EQ(cell.state().session, SessionState::kCommandingActive);

  SimulatedCell other(params, ScriptBelow(params, 10.0));
  TestClient poor;
  now_ms = 0;
  for (int k = 0; k < 25'000; ++k)
    if (const auto message = other.Step(++now_ms * rt::kMillisecond); k % 30 == 0 && !message.empty())
      other.Receive(poor.Answer(message));
  EXPECT_EQ(other.state().session, SessionState::kIdle);
  EXPECT_EQ(other.state().stop.reason, StopReason::kQualityTimeout);
}

// The external torque of joint i must equal the work of the hand's wrench for a unit rotation of joint i. The
// work is computed from differences of the forward kinematics. The wrench that is computed in one step acts
// in the next step.
TEST(SimulatedCell, ExternalTorqueEqualsTheHandsVirtualWork) {
  const SimulatedCellParams params = CellParams();
  SimulatedCell cell(params, ScriptBelow(params, 1.0));
  TestClient client;
  Bytes message;
  Wrench F;
  for (int k = 0; k < 5000 && cell.state().cell_time_s < 0.5; ++k) {
    F = cell.state().F_hand_T_W;
    const auto bytes = cell.Step(k * rt::kMillisecond);
    message.assign(bytes.begin(), bytes.end());
    cell.Receive(client.Answer(message));
  }
  ASSERT_GT(F.f.norm(), 10.0);
  ASSERT_GT(F.t.norm(), 0.1);
  const auto tau = DoublesAt(message, {3, 5, 1});
  ASSERT_EQ(tau.size(), 7u);
  const double h = 1e-6;
  for (int i = 0; i < 7; ++i) {
    JointVector a = Eigen::Map<const JointVector>(cell.state().q_meas.data()), b = a;
    a[i] -= h, b[i] += h;
    const Pose X_a = ToolPose(params, a), X_b = ToolPose(params, b);
    const double work = F.f.dot(X_b.translation() - X_a.translation()) +
                        F.t.dot(LogRotation(X_b.linear() * X_a.linear().transpose()));
    EXPECT_NEAR(tau[static_cast<std::size_t>(i)], work / (2 * h), 1e-6) << i;
  }
}

TEST(SimulatedCell, MeasuredToolPoseFollowsFromTheJointsAndLagsTheCommand) {
  const SimulatedCellParams params = CellParams();
  SimulatedCell cell(params, ScriptBelow(params, 10.0));
  TestClient client;
  for (int k = 0; k < 2000; ++k) {
    if (cell.state().session == SessionState::kCommandingActive) client.offset[0] += 2e-4;  // A1 at 0.2 rad/s
    cell.Receive(client.Answer(cell.Step(k * rt::kMillisecond)));
  }
  const CellState& s = cell.state();
  ASSERT_EQ(s.session, SessionState::kCommandingActive);
  const Pose X_WT = ToolPose(params, Eigen::Map<const JointVector>(s.q_meas.data()));
  EXPECT_TRUE(Pose(s.X_WT_meas).isApprox(X_WT, 1e-12));
  // At 0.2 rad/s the lag is the sum of the servo's 2 z / w = 21.2 ms, 3 ms of dead time and 0.5 ms of
  // sample-and-hold. 1 ms is subtracted, because the state is shown one period after the command.
  EXPECT_NEAR(s.q_cmd[0] - s.q_meas[0], 0.2 * (0.02122 + 0.0030 + 0.0005 - 0.001), 1e-5);
}

// Compares the velocity with a central difference over 2 ms, while all joints move. The error is T^2/6 of the
// jerk, which is about 1 m/s^3 once the transient of the start has died out.
TEST(SimulatedCell, MeasuredToolVelocityIsTheDerivativeOfItsPose) {
  const SimulatedCellParams params = CellParams();
  SimulatedCell cell(params, ScriptBelow(params, 10.0));
  TestClient client;
  CellState before, middle;
  for (int k = 0; k < 2000; ++k) {
    if (cell.state().session == SessionState::kCommandingActive)
      for (std::size_t i = 0; i < 7; ++i) client.offset[i] += (i % 2 == 0 ? 1e-4 : -8e-5);
    before = middle;
    middle = cell.state();
    cell.Receive(client.Answer(cell.Step(k * rt::kMillisecond)));
  }
  ASSERT_EQ(cell.state().session, SessionState::kCommandingActive);
  const Pose X_a = before.X_WT_meas, X_b = cell.state().X_WT_meas;
  const Vector3 v = (X_b.translation() - X_a.translation()) / 2e-3;
  const Vector3 w = LogRotation(X_b.linear() * X_a.linear().transpose()) / 2e-3;
  EXPECT_LT((Vector3(middle.v_WT_meas_m_per_s) - v).norm(), 3e-4);
  EXPECT_LT((Vector3(middle.w_WT_meas_rad_per_s) - w).norm(), 3e-4);
  EXPECT_GT(v.norm(), 0.01);
  EXPECT_GT(w.norm(), 0.05);
}

}  // namespace
}  // namespace osteon::hil
