// Tests FRI between the simulated arm, which uses libprotobuf, and the product's client, which has its own
// codec. Both implementations of the protocol must agree.

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "hil/simulated_cell_thread.h"
#include "io/fri/fri_link.h"
#include "io/fri/fri_session.h"
#include "test_client.h"

namespace osteon::hil {
namespace {

using control::SessionState;

SimulatedCellParams CellParams() {
  SimulatedCellParams params;
  params.arm = kinematics::Iiwa14();
  params.q_start = {0.1, 0.6, -0.2, -1.3, 0.3, 0.9, -0.4};
  return params;
}

TEST(FriInterop, SessionReachesActiveAndEveryValueArrives) {
  SimulatedCell cell(CellParams(), MakeReamingScript({}));
  io::FriSession session;
  control::ArmState arm;
  control::ArmCommand command{.q = CellParams().q_start};
  for (int k = 1; k <= 2000; ++k) {
    const rt::Nanoseconds now = k * rt::kMillisecond;
    const auto message = cell.Step(now);
    ASSERT_EQ(session.Accept(message, now, arm), io::FriAccept::kAccepted)
        << io::Describe(session.last_error());
    const CellState& s = cell.state();
    ASSERT_EQ(arm.session, s.session);
    ASSERT_EQ(arm.q_meas, s.q_meas);
    ASSERT_EQ(arm.sequence, s.counters.sent);
    ASSERT_EQ(arm.has_ipo, s.session >= SessionState::kCommandingWait);
    if (arm.has_ipo) {
      ASSERT_EQ(arm.q_ipo, CellParams().q_start);
    }
    ASSERT_EQ(arm.safety_state, 0);
    ASSERT_EQ(arm.period_s, 1e-3);
    command.activation = arm.activation;
    if (s.session == SessionState::kCommandingActive) command.q[0] += 1e-4;
    cell.Receive(session.Answer(command));
  }
  EXPECT_EQ(arm.session, SessionState::kCommandingActive);
  EXPECT_EQ(arm.quality, 3);
  EXPECT_EQ(arm.lost + arm.duplicate + arm.late + arm.rejected, 0u);
  const FriCounters& n = cell.state().counters;
  EXPECT_EQ(n.answered, n.sent - 1);
  EXPECT_EQ(n.lost + n.stale + n.duplicate + n.malformed + n.incomplete, 0u);
  EXPECT_NEAR(arm.q_meas[0], command.q[0], 5e-3);  // the lag of about 25 ms at 0.1 rad/s gives 2.5 mrad
  EXPECT_GT(arm.q_meas[0], 0.11);
}

// A cell and a client in lockstep. While the session holds the arm, the command follows the arm's present
// joint angles. Afterwards the test may change `command`.
struct ArmAndClient {
  ArmAndClient(const SimulatedCellParams& params, const io::FriSessionParams& client)
      : cell(params, MakeReamingScript({})), session(client) {}

  // Runs one cycle: a message and its answer. Returns whether the client has accepted the message.
  bool Step() {
    const rt::Nanoseconds now = ++cycle * rt::kMillisecond;
    const auto message = cell.Step(now);
    if (message.empty()) return false;
    const bool accepted = session.Accept(message, now, arm) == io::FriAccept::kAccepted;
    if (arm.holding && follow) command = {.q = arm.q_ipo, .activation = arm.activation, .F = F, .tau = tau};
    const auto answer = session.Answer(command);
    if (!answer.empty()) cell.Receive(answer);
    return accepted;
  }
  // Runs cycles until this state is reached. Returns false if it is not reached within 5000 cycles.
  bool StepUntil(SessionState state) {
    for (int i = 0; i < 5000 && arm.session != state; ++i) Step();
    return arm.session == state;
  }

  SimulatedCell cell;
  io::FriSession session;
  control::ArmState arm;
  control::ArmCommand command;
  bool follow{true};  // false: the command stays unchanged while the session holds the arm
  PlainWrench F;
  control::JointArray tau{};
  rt::Nanoseconds cycle{0};
};

TEST(FriInterop, EveryVersionPeriodAndMultiplierReachesActive) {
  for (const io::FriVersion version : io::kFriVersions)
    for (const int period_ms : {1, 2, 5, 10})
      for (const int multiplier : {1, 3}) {
        SCOPED_TRACE(std::string(Name(version)) + ", " + std::to_string(period_ms) + " ms, every " +
                     std::to_string(multiplier));
        SimulatedCellParams params = CellParams();
        params.fri.version = version;
        params.fri.send_period_ms = period_ms;
        params.fri.receive_multiplier = multiplier;
        params.fri.quality.good_after_answers = 20;
        params.fri.quality.excellent_after_answers = 30;
        params.fri.request_after_good_cycles = 10;
        params.fri.activate_after_mirrored_answers = 5;
        ArmAndClient pair(params, {.version = version});
        ASSERT_TRUE(pair.StepUntil(SessionState::kCommandingActive)) << pair.session.Diagnosis();
        for (int i = 0; i < 30; ++i) {
          ASSERT_TRUE(pair.Step());
          pair.command.q[0] += 1e-5;
        }
        EXPECT_DOUBLE_EQ(pair.arm.period_s, 1e-3 * period_ms);
        EXPECT_GT(pair.cell.state().q_cmd[0], CellParams().q_start[0] + 1e-4);
        const control::ArmState& n = pair.arm;
        EXPECT_EQ(n.lost + n.duplicate + n.late + n.reordered + n.rejected, 0u);
        EXPECT_EQ(n.answers_lost + n.answers_foreign, 0u);
        const FriCounters& c = pair.cell.state().counters;
        EXPECT_EQ(c.lost + c.stale + c.duplicate + c.malformed + c.incomplete + c.ignored + c.client_gap +
                      c.client_back,
                  0u);
        EXPECT_EQ(pair.session.Diagnosis(), "");
      }
}

TEST(FriInterop, ArmAndClientEachDetectTheOthersVersion) {
  constexpr std::array kFamilies{io::FriVersion::k1_15, io::FriVersion::k2_5, io::FriVersion::k2_7};
  for (const io::FriVersion arm : kFamilies)
    for (const io::FriVersion client : kFamilies) {
      if (arm == client) continue;
      SimulatedCellParams params = CellParams();
      params.fri.version = arm;
      ArmAndClient pair(params, {.version = client});
      for (int i = 0; i < 100; ++i) EXPECT_FALSE(pair.Step());
      EXPECT_EQ(pair.arm.other_version, 100u);
      EXPECT_EQ(pair.session.other_family(), io::FamilyOf(arm));
      EXPECT_NE(pair.session.Diagnosis().find(Describe(io::FamilyOf(arm))), std::string::npos);
      // a client whose version has the other framing, and which answers nevertheless
      FriServer server(params.fri, params.arm.limits, kinematics::JointVector::Constant(0.1));
      server.Open();
      (void)server.BeginCycle({}, 1);
      io::CommandMessage answer{.sequence = 1, .reflected_sequence = 1};
      std::array<std::uint8_t, io::kFriMaxDatagram> bytes{};
      std::size_t size = 0;
      ASSERT_EQ(io::EncodeCommand(io::FamilyOf(client), answer, bytes, size), io::CodecError::kNone);
      const bool framing_differs = (arm == io::FriVersion::k2_7) != (client == io::FriVersion::k2_7);
      EXPECT_EQ(server.Receive({bytes.data(), size}), !framing_differs);
      EXPECT_EQ(server.counters().other_version, framing_differs ? 1u : 0u);
    }
}

// The torques differ, so a wrong order of the axes (XYZ or ZYX) on one side would be noticed.
TEST(FriInterop, WrenchAndTorqueArriveInEveryVersion) {
  for (const io::FriVersion version : io::kFriVersions)
    for (const bool zyx : {true, false}) {
      SCOPED_TRACE(Name(version));
      SimulatedCellParams params = CellParams();
      params.fri.version = version;
      params.fri.torques_zyx = zyx;
      params.fri.control_mode = control::ControlMode::kCartesianImpedance;
      params.fri.command_mode = control::CommandMode::kWrench;
      ArmAndClient pair(params, {.version = version,
                                 .torque_order = zyx ? io::FriTorqueOrder::kZyx : io::FriTorqueOrder::kXyz});
      pair.F.f = Vector3(10, 20, 30);
      pair.F.t = Vector3(1, 2, 3);
      ASSERT_TRUE(pair.StepUntil(SessionState::kCommandingActive));
      EXPECT_EQ(pair.cell.server().F_commanded().f.norm(), 0.0);
      pair.Step();
      pair.Step();
      EXPECT_EQ(pair.cell.server().F_commanded().f, Vector3(10, 20, 30));
      EXPECT_EQ(pair.cell.server().F_commanded().t, Vector3(1, 2, 3));
      EXPECT_EQ(pair.arm.command_mode, control::CommandMode::kWrench);
      EXPECT_EQ(pair.arm.control_mode, control::ControlMode::kCartesianImpedance);
    }
  SimulatedCellParams params = CellParams();
  params.fri.control_mode = control::ControlMode::kJointImpedance;
  params.fri.command_mode = control::CommandMode::kTorque;
  ArmAndClient pair(params, {});
  pair.tau = {1, 2, 3, 4, 5, 6, 7};
  ASSERT_TRUE(pair.StepUntil(SessionState::kCommandingActive));
  pair.Step();
  pair.Step();
  EXPECT_EQ(pair.cell.server().tau_commanded()[6], 7.0);
}

// Six lost answers end the commanding, and the arm requests it again. A loop that has not noticed this still
// sends its old commands. They must not move the arm until the loop starts again at the arm's pose.
TEST(FriInterop, AfterReEntryTheArmIsHeldUntilTheLoopStartsAtItsPose) {
  SimulatedCellParams params = CellParams();
  params.fri.request_again_after_loss = true;
  ArmAndClient pair(params, {});
  ASSERT_TRUE(pair.StepUntil(SessionState::kCommandingActive));
  for (int i = 0; i < 100; ++i) {
    pair.Step();
    pair.command.q[0] += 1e-4;
  }
  pair.follow = false;  // the loop continues as if the arm had not ended the commanding
  for (int i = 0; i < 6; ++i) (void)pair.cell.Step(++pair.cycle * rt::kMillisecond);
  ASSERT_EQ(pair.cell.state().stop.reason, StopReason::kLostInARow);
  pair.Step();
  EXPECT_EQ(pair.arm.lost, 6u);
  ASSERT_TRUE(pair.StepUntil(SessionState::kCommandingActive));
  EXPECT_EQ(pair.arm.activation, 2u);
  const control::JointArray rest = pair.arm.q_ipo;
  for (int i = 0; i < 300; ++i) {
    pair.command.q[0] += 1e-4;
    pair.Step();
    ASSERT_EQ(pair.cell.state().q_cmd, rest);
  }
  EXPECT_TRUE(pair.arm.holding);
  EXPECT_NE(pair.session.Diagnosis().find("held"), std::string::npos);
  EXPECT_EQ(pair.cell.state().session, SessionState::kCommandingActive) << "held, not lost";
  pair.follow = true;
  for (int i = 0; i < 100; ++i) {
    pair.Step();
    pair.command.q[0] += 1e-4;
  }
  EXPECT_FALSE(pair.arm.holding);
  EXPECT_GT(pair.cell.state().q_cmd[0], rest[0] + 5e-3);
  EXPECT_NE(pair.cell.state().stop.reason, StopReason::kJointStep);
}

TEST(FriInterop, TheClientReportsASafetyStopAndRecovers) {
  ArmAndClient pair(CellParams(), {.version = io::FriVersion::k1_15});
  ASSERT_TRUE(pair.StepUntil(SessionState::kCommandingActive));
  EXPECT_TRUE(pair.arm.drives_active);
  pair.cell.server().EmergencyStop(0);
  for (int i = 0; i < 3; ++i) pair.Step();
  EXPECT_EQ(pair.arm.safety_state, 1);
  EXPECT_FALSE(pair.arm.drives_active);
  EXPECT_NE(pair.session.Diagnosis().find("safety stop (level 0) and ignores commands"), std::string::npos);
  pair.cell.server().Acknowledge();
  EXPECT_TRUE(pair.StepUntil(SessionState::kCommandingActive));
  EXPECT_EQ(pair.arm.activation, 2u);
}

// Three arms with three versions of FRI run in real time, each on its own UDP port.
TEST(FriInterop, SeveralArmsRunSideBySide) {
  constexpr std::array kVersions{io::FriVersion::k1_11, io::FriVersion::k2_5, io::FriVersion::k2_7};
  std::vector<std::unique_ptr<io::FriLink>> links;
  std::vector<std::unique_ptr<SimulatedCellThread>> cells;
  for (const io::FriVersion version : kVersions) {
    auto link = io::FriLink::Open({.port = 0, .session = {.version = version}});
    ASSERT_TRUE(link) << link.error();
    SimulatedCellParams params = CellParams();
    params.fri.version = version;
    params.fri.quality = {.good_max_lost_per_s = 1000000,
                          .end_after_lost_in_a_row = 1000000,
                          .end_after_lost_per_s = 1000000,
                          .good_timeout_s = 3600.0};
    links.push_back(std::move(*link));
    cells.push_back(std::make_unique<SimulatedCellThread>(
        CellThreadParams{.client_port = links.back()->port()}, SimulatedCell(params, MakeReamingScript({}))));
  }
  std::array<control::ArmState, kVersions.size()> arms;
  const auto all_active = [&] {
    return std::all_of(arms.begin(), arms.end(),
                       [](const auto& arm) { return arm.session == SessionState::kCommandingActive; });
  };
  for (int k = 0; k < 20000 && !all_active(); ++k)
    for (std::size_t i = 0; i < links.size(); ++i) {
      ASSERT_EQ(links[i]->Receive(arms[i], rt::MonotonicNow() + 2 * rt::kSecond),
                control::ReceiveResult::kOk);
      ASSERT_TRUE(links[i]->Send({.q = arms[i].q_ipo, .activation = arms[i].activation}));
    }
  EXPECT_TRUE(all_active());
  for (std::size_t i = 0; i < links.size(); ++i) {
    cells[i]->Stop();
    EXPECT_EQ(cells[i]->statistics().cell.counters.malformed, 0u);
    EXPECT_EQ(arms[i].rejected, 0u);
  }
}

TEST(FriInterop, LinkReachesActiveOverUdp) {
  SimulatedCellParams params =
      CellParams();  // with these parameters, a delay by a busy machine does not end the session
  params.fri.quality = {.good_max_lost_per_s = 1000000,
                        .end_after_lost_in_a_row = 1000000,
                        .end_after_lost_per_s = 1000000,
                        .good_timeout_s = 3600.0};
  auto link = io::FriLink::Open({.port = 0});
  ASSERT_TRUE(link) << link.error();
  SimulatedCellThread cell({.client_port = (*link)->port()}, SimulatedCell(params, MakeReamingScript({})));
  control::ArmState arm;
  for (int k = 0; k < 20000 && arm.session != SessionState::kCommandingActive; ++k) {
    const auto result = (*link)->Receive(arm, rt::MonotonicNow() + 2 * rt::kSecond);
    ASSERT_EQ(result, control::ReceiveResult::kOk);
    ASSERT_TRUE((*link)->Send({.q = params.q_start}));
  }
  EXPECT_EQ(arm.session, SessionState::kCommandingActive);
  cell.Stop();
  EXPECT_EQ(cell.statistics().cell.counters.malformed, 0u);
  EXPECT_EQ(arm.rejected, 0u);
}

}  // namespace
}  // namespace osteon::hil
