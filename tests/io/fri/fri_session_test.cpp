#include <limits>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"
#include "tests/io/fri/fri_session_fixture.h"

// FriSession's answers in each session state, version and command mode, and the conditions under which it
// passes on the loop's commands.

namespace osteon::io {
namespace {

using control::ArmCommand;
using test::Bytes;
using test::Datagram;
using test::Joints;
using test::Monitoring;

TEST_F(FriSessionTest, StateHoldsTheMessagesValues) {
  fri::FRIMonitoringMessage m = Monitoring(77, fri::COMMANDING_ACTIVE);
  m.mutable_connectioninfo()->set_sendperiod(2);
  m.mutable_robotinfo()->set_safetystate(fri::STOP_LEVEL_2);
  m.mutable_ipodata()->set_clientcommandmode(fri::TORQUE);
  m.mutable_robotinfo()->set_controlmode(fri::JOINT_IMPEDANCE);
  ASSERT_EQ(session_.Accept(Bytes(m), 123, state_), FriAccept::kAccepted);
  EXPECT_EQ(state_.operation_mode, 2);
  EXPECT_TRUE(state_.drives_active);
  EXPECT_EQ(state_.command_mode, control::CommandMode::kTorque);
  EXPECT_EQ(state_.control_mode, control::ControlMode::kJointImpedance);
  EXPECT_EQ(state_.stamp, 123);
  EXPECT_EQ(state_.sequence, 77u);
  EXPECT_EQ(state_.session, control::SessionState::kCommandingActive);
  EXPECT_EQ(state_.quality, 3);
  EXPECT_EQ(state_.safety_state, 3);
  EXPECT_DOUBLE_EQ(state_.period_s, 0.002);
  EXPECT_EQ(state_.q_meas, Joints(0.1));
  EXPECT_TRUE(state_.has_ipo);
  EXPECT_EQ(state_.q_ipo, Joints(0.3));
  EXPECT_EQ(state_.tau_ext, Joints(-3.0));
  m.mutable_header()->set_sequencecounter(78);
  m.mutable_robotinfo()->set_drivestate(3, fri::OFF);
  ASSERT_EQ(session_.Accept(Bytes(m), 124, state_), FriAccept::kAccepted);
  EXPECT_FALSE(state_.drives_active);
}

TEST_F(FriSessionTest, AnswersAsEachSessionStateRequires) {
  const auto q = Joints(0.9);
  AcceptMessage(0, fri::IDLE);
  EXPECT_TRUE(session_.Answer(ArmCommand{.q = q}).empty());
  AcceptMessage(1, fri::MONITORING_WAIT);
  EXPECT_EQ(Position(Answer(q)), Joints(0.2)) << "mirrors the commanded position";
  AcceptMessage(2, fri::MONITORING_READY);
  EXPECT_EQ(Position(Answer(q)), Joints(0.2));
  AcceptMessage(3, fri::COMMANDING_WAIT);
  EXPECT_EQ(Position(Answer(q)), Joints(0.3)) << "mirrors the interpolator";
  AcceptMessage(4, fri::COMMANDING_ACTIVE);
  EXPECT_EQ(Position(Answer(q)), q);
}

TEST_F(FriSessionTest, SendsTheHeaderAloneIfThereIsNoPositionToMirror) {
  fri::FRIMonitoringMessage m = Monitoring(1, fri::MONITORING_READY);
  m.mutable_monitordata()->clear_commandedjointposition();
  session_.Accept(Bytes(m), 1, state_);
  const auto answer = Answer(Joints(0.9));
  EXPECT_FALSE(answer.has_commanddata());
  EXPECT_EQ(answer.header().reflectedsequencecounter(), 1u);
}

// In COMMANDING_WAIT the arm checks that a wrench or torque is present but ignores its value, so the session
// sends zeros.
TEST_F(FriSessionTest, SendsTheLoopsWrenchOrTorqueIfTheArmRequestsIt) {
  ArmCommand command{.q = Joints(0.3)};
  command.F.f = Vector3(1, 2, 3);
  command.F.t = Vector3(40, 50, 60);
  command.tau = Joints(7.0);
  std::uint32_t sequence = 0;
  const auto answer = [&](fri::SessionState state, fri::ClientCommandMode mode) {
    fri::FRIMonitoringMessage m = Monitoring(++sequence, state);
    m.mutable_ipodata()->set_clientcommandmode(mode);
    EXPECT_EQ(session_.Accept(Bytes(m), 1, state_), FriAccept::kAccepted);
    command.activation = state_.activation;
    const auto sent = test::Command(session_.Answer(command));
    EXPECT_TRUE(sent && sent->commanddata().has_jointposition());
    return sent->commanddata();
  };
  const auto elements = [](const fri::MessageCommandData& data) {
    const auto& element = data.cartesianwrenchfeedforward().element();
    return std::vector<double>(element.begin(), element.end());
  };

  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(elements(answer(fri::COMMANDING_WAIT, fri::WRENCH)), std::vector<double>(6, 0.0));
  const auto wrench = answer(fri::COMMANDING_ACTIVE, fri::WRENCH);
  EXPECT_EQ(elements(wrench), (std::vector<double>{1, 2, 3, 60, 50, 40})) << "about z, y, x";
  EXPECT_FALSE(wrench.has_jointtorque());
  command.F.t = Vector3(std::numeric_limits<double>::quiet_NaN(), 0, 0);
  EXPECT_EQ(elements(answer(fri::COMMANDING_ACTIVE, fri::WRENCH)), std::vector<double>(6, 0.0));

  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(test::Values(answer(fri::COMMANDING_WAIT, fri::TORQUE).jointtorque()), control::JointArray{});
  const auto torque = answer(fri::COMMANDING_ACTIVE, fri::TORQUE);
  EXPECT_EQ(test::Values(torque.jointtorque()), Joints(7.0));
  EXPECT_FALSE(torque.has_cartesianwrenchfeedforward());
  command.tau[2] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(test::Values(answer(fri::COMMANDING_ACTIVE, fri::TORQUE).jointtorque()), control::JointArray{});

  const auto position = answer(fri::COMMANDING_ACTIVE, fri::POSITION);
  EXPECT_FALSE(position.has_jointtorque() || position.has_cartesianwrenchfeedforward());
}

TEST_F(FriSessionTest, SendsTheWrenchsTorquesInTheConfiguredOrder) {
  for (const bool xyz : {false, true}) {
    FriSession session(
        {.version = FriVersion::k2_7, .torque_order = xyz ? FriTorqueOrder::kXyz : FriTorqueOrder::kZyx});
    fri::FRIMonitoringMessage m = Monitoring(1, fri::COMMANDING_ACTIVE, FriFamily::k2_7);
    m.mutable_ipodata()->set_clientcommandmode(fri::WRENCH);
    ASSERT_EQ(session.Accept(Datagram(FriFamily::k2_7, m), 1, state_), FriAccept::kAccepted);
    ArmCommand command{.q = Joints(0.3), .activation = state_.activation};
    command.F.f = Vector3(10, 20, 30);
    command.F.t = Vector3(4, 5, 6);
    const auto sent = test::Command(session.Answer(command), FriFamily::k2_7);
    ASSERT_TRUE(sent);
    const auto& element = sent->commanddata().cartesianwrenchfeedforward().element();
    EXPECT_EQ(std::vector<double>(element.begin(), element.end()),
              xyz ? (std::vector<double>{10, 20, 30, 4, 5, 6}) : (std::vector<double>{10, 20, 30, 6, 5, 4}));
  }
}

TEST_F(FriSessionTest, AnswersAsEachVersionRequires) {
  for (const FriVersion version : kFriVersions) {
    SCOPED_TRACE(Name(version));
    const FriFamily family = FamilyOf(version);
    FriSession session({.version = version});
    std::uint32_t sequence = 0;
    for (const auto state :
         {fri::MONITORING_WAIT, fri::MONITORING_READY, fri::COMMANDING_WAIT, fri::COMMANDING_ACTIVE}) {
      ASSERT_EQ(session.Accept(Datagram(family, Monitoring(++sequence, state, family)), 1, state_),
                FriAccept::kAccepted);
      const auto sent =
          test::Command(session.Answer({.q = Joints(0.31), .activation = state_.activation}), family);
      ASSERT_TRUE(sent);
      const bool monitoring = state < fri::COMMANDING_WAIT;
      EXPECT_EQ(sent->has_commanddata(), !monitoring || family == FriFamily::k1);
      if (sent->has_commanddata()) {
        EXPECT_EQ(Position(*sent), Joints(monitoring ? 0.2 : state == fri::COMMANDING_WAIT ? 0.3 : 0.31));
      }
    }
  }
}

TEST_F(FriSessionTest, MirrorsTheArmsPoseIfItRequestsCartesianPoses) {
  FriSession session({.version = FriVersion::k2_5});
  fri::FRIMonitoringMessage m = Monitoring(1, fri::COMMANDING_ACTIVE, FriFamily::k2_5);
  m.mutable_ipodata()->set_clientcommandmode(fri::CARTESIAN_POSE);
  ASSERT_EQ(session.Accept(Bytes(m), 1, state_), FriAccept::kAccepted);
  const auto sent = test::Command(session.Answer({.q = Joints(0.31), .activation = state_.activation}));
  ASSERT_TRUE(sent);
  EXPECT_EQ(Bytes(sent->commanddata().cartesianpose()), Bytes(m.ipodata().cartesianpose()));
  EXPECT_EQ(sent->commanddata().redundancyinformation().value(), 0.25);
  EXPECT_EQ(Position(*sent), Joints(0.3));
  EXPECT_NE(session.Diagnosis().find("CARTESIAN_POSE"), std::string::npos);
}

// The arm has left COMMANDING_ACTIVE and returned. A loop that has not noticed this must not move the arm:
// the loop's commands still have the number of the older activation.
TEST_F(FriSessionTest, HoldsTheInterpolatorsPositionUntilACommandNamesTheActivation) {
  FriSession session;
  std::uint32_t sequence = 0;
  const auto answer = [&](fri::SessionState state, double first_joint, std::uint32_t activation) {
    session.Accept(Bytes(Monitoring(++sequence, state)), 1, state_);
    const auto sent = test::Command(
        session.Answer({.q = Joints(first_joint), .activation = activation, .tau = Joints(9.0)}));
    EXPECT_TRUE(sent);
    return Position(*sent);
  };
  EXPECT_EQ(answer(fri::COMMANDING_WAIT, 0.3, 0), Joints(0.3));
  EXPECT_EQ(state_.activation, 0u);
  EXPECT_EQ(answer(fri::COMMANDING_ACTIVE, 0.31, 0), Joints(0.3)) << "not told yet";
  EXPECT_EQ(state_.activation, 1u);
  EXPECT_TRUE(state_.holding);
  EXPECT_NE(session.Diagnosis().find("held"), std::string::npos);
  EXPECT_EQ(answer(fri::COMMANDING_ACTIVE, 0.35, 1), Joints(0.3)) << "told, but it would jump";
  EXPECT_EQ(answer(fri::COMMANDING_ACTIVE, 0.31, 1), Joints(0.31));
  EXPECT_EQ(answer(fri::COMMANDING_ACTIVE, 0.4, 1), Joints(0.4)) << "its own way from here on";
  EXPECT_FALSE(state_.holding);
  EXPECT_EQ(session.Diagnosis(), "");
  EXPECT_EQ(answer(fri::COMMANDING_ACTIVE, 0.5, 7), Joints(0.4)) << "a command for another activation";

  EXPECT_EQ(answer(fri::MONITORING_READY, 0.4, 1), Joints(0.2));
  EXPECT_EQ(answer(fri::COMMANDING_WAIT, 0.4, 1), Joints(0.3));
  for (int i = 0; i < 10; ++i) EXPECT_EQ(answer(fri::COMMANDING_ACTIVE, 0.3, 1), Joints(0.3));
  EXPECT_EQ(answer(fri::COMMANDING_ACTIVE, 0.31, 1), Joints(0.3)) << "an old loop goes on";
  EXPECT_EQ(state_.activation, 2u);
  EXPECT_EQ(answer(fri::COMMANDING_ACTIVE, 0.31, 2), Joints(0.31));

  sequence += 63;  // 63 messages lost: the arm may have left COMMANDING_ACTIVE and returned
  EXPECT_EQ(answer(fri::COMMANDING_ACTIVE, 0.31, 2), Joints(0.3));
  EXPECT_EQ(state_.activation, 3u);
  EXPECT_EQ(answer(fri::COMMANDING_ACTIVE, 0.31, 3), Joints(0.31));
  sequence += 62;
  EXPECT_EQ(answer(fri::COMMANDING_ACTIVE, 0.32, 3), Joints(0.32));
}

TEST_F(FriSessionTest, HoldsTheLastPositionIfTheCommandIsNotFinite) {
  AcceptMessage(1, fri::COMMANDING_WAIT);
  (void)Answer(Joints(0.0));
  auto bad = Joints(0.5);
  bad[6] = std::numeric_limits<double>::quiet_NaN();
  AcceptMessage(2, fri::COMMANDING_ACTIVE);
  EXPECT_EQ(Position(Answer(bad)), Joints(0.3)) << "what COMMANDING_WAIT mirrored";
  AcceptMessage(3, fri::COMMANDING_ACTIVE);
  (void)Answer(Joints(0.4));
  AcceptMessage(4, fri::COMMANDING_ACTIVE);
  bad[6] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(Position(Answer(bad)), Joints(0.4));
}

// After ResetSession() the session must not hold a position that it sent before: the arm may have moved
// meanwhile, or may be a different arm.
TEST_F(FriSessionTest, AfterAResetThePositionBeforeIsNotHeld) {
  control::JointArray bad{};
  bad.fill(std::numeric_limits<double>::quiet_NaN());
  AcceptMessage(1000, fri::COMMANDING_ACTIVE);
  ASSERT_EQ(Position(Answer(Joints(0.9))), Joints(0.9));
  session_.ResetSession();
  AcceptMessage(5, fri::COMMANDING_ACTIVE);
  EXPECT_EQ(Position(Answer(bad)), Joints(0.3)) << "the interpolator's";
}

TEST_F(FriSessionTest, HoldsTheInterpolatorsPositionIfTheFirstCommandIsNotFinite) {
  AcceptMessage(1, fri::COMMANDING_ACTIVE);
  control::JointArray bad{};
  bad.fill(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(Position(Answer(bad)), Joints(0.3));
}

TEST_F(FriSessionTest, NeitherAllocatesNorLocksInAnyVersionAndMode) {
  for (const FriVersion version : kFriVersions)
    for (const auto mode : {fri::POSITION, fri::WRENCH, fri::TORQUE, fri::CARTESIAN_POSE}) {
      const FriFamily family = FamilyOf(version);
      if (mode == fri::CARTESIAN_POSE && family == FriFamily::k1) continue;
      FriSession session({.version = version});
      fri::FRIMonitoringMessage m = Monitoring(8, fri::COMMANDING_ACTIVE, family);
      m.mutable_ipodata()->set_clientcommandmode(mode);
      m.add_requestedtransformations()->set_name("cup");
      auto* io = m.mutable_monitordata()->add_readiorequest();
      io->set_name("On");
      io->set_type(fri::BOOLEAN);
      io->set_direction(fri::OUTPUT);
      const auto bytes = Datagram(family, m);
      const FriFamily stranger = family == FriFamily::k2_7 ? FriFamily::k1 : FriFamily::k2_7;
      const auto other = Datagram(stranger, Monitoring(9, fri::IDLE, stranger));
      rt::CheckedNoAllocScope no_alloc;
      const FriAccept accepted = session.Accept(bytes, 1, state_);
      (void)session.Accept(other, 1, state_);
      const std::size_t size =
          session.Answer({.q = state_.q_ipo, .activation = state_.activation, .tau = state_.tau_ext}).size();
      no_alloc.End();
      EXPECT_EQ(accepted, FriAccept::kAccepted);
      EXPECT_GE(size, 77u) << "a command has seven joints at least";
    }
}

}  // namespace
}  // namespace osteon::io
