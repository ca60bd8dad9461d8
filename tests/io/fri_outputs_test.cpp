#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "tests/io/fri_session_fixture.h"

// Outputs and frames that are sent with the answers.

namespace osteon::io {
namespace {

using test::Bytes;
using test::Joints;
using test::Monitoring;

// Only what the robot program registered: unknown names would end its session.
class FriOutputsTest : public FriSessionTest {
 protected:
  fri::FRICommandMessage Cycle(std::uint32_t reflected) {
    fri::FRIMonitoringMessage m = Monitoring(++sequence_, fri::MONITORING_READY);
    m.mutable_header()->set_reflectedsequencecounter(reflected);
    const auto add = [&m](const char* name, fri::IOType type, fri::IODirection direction) {
      auto* io = m.mutable_monitordata()->add_readiorequest();
      io->set_name(name);
      io->set_type(type);
      io->set_direction(direction);
    };
    add("On", fri::BOOLEAN, fri::OUTPUT);
    add("Flow", fri::ANALOG, fri::OUTPUT);
    add("Ready", fri::BOOLEAN, fri::INPUT);
    if (asks_) m.add_requestedtransformations()->set_name("cup");
    EXPECT_EQ(session_.Accept(Bytes(m), 1, state_), FriAccept::kAccepted);
    return Answer(Joints(0.0));
  }
  std::uint32_t sequence_{0};
  bool asks_{true};
};

TEST_F(FriOutputsTest, AreRefusedWhereTheRobotProgramDoesNotKnowThem) {
  EXPECT_EQ(session_.Write({.name = FriName("On"), .digital = 1}), FriOutputError::kUnknown)
      << "no message yet";
  Cycle(0);
  EXPECT_EQ(session_.Write({.name = FriName("Off"), .digital = 1}), FriOutputError::kUnknown);
  EXPECT_EQ(session_.Write({.name = FriName("Ready"), .digital = 1}), FriOutputError::kNotOutput);
  EXPECT_EQ(session_.Write({.name = FriName("On"), .analog = 1}), FriOutputError::kWrongType);
  EXPECT_EQ(session_.Write({.name = FriName("On"), .type = FriIoType::kDigital, .digital = 1}),
            FriOutputError::kWrongType);
  EXPECT_EQ(session_.Write({.name = FriName("Flow"),
                            .type = FriIoType::kAnalog,
                            .analog = std::numeric_limits<double>::quiet_NaN()}),
            FriOutputError::kWrongType);
  EXPECT_EQ(session_.Transform({.name = FriName("bone")}), FriOutputError::kUnknown);
  const auto answer = Cycle(1);
  EXPECT_EQ(answer.commanddata().writeiorequest_size(), 0);
  EXPECT_EQ(answer.commanddata().commandedtransformations_size(), 0);
}

TEST_F(FriOutputsTest, WritesAreRepeatedUntilTheArmHasTakenAnAnswerWithThem) {
  Cycle(0);  // our answer 1
  ASSERT_EQ(session_.Write({.name = FriName("On"), .digital = 1}), FriOutputError::kNone);
  ASSERT_EQ(session_.Write({.name = FriName("Flow"), .type = FriIoType::kAnalog, .analog = 0.5}),
            FriOutputError::kNone);
  ASSERT_EQ(session_.Write({.name = FriName("On"), .digital = 0}),
            FriOutputError::kNone);  // the newest counts
  for (int i = 0; i < 3; ++i) {      // answers 2, 3, 4; the arm has seen the first
    const auto answer = Cycle(1);
    ASSERT_EQ(answer.commanddata().writeiorequest_size(), 2);
    EXPECT_EQ(answer.commanddata().writeiorequest(0).name(), "On");
    EXPECT_EQ(answer.commanddata().writeiorequest(0).digitalvalue(), 0u);
    EXPECT_EQ(answer.commanddata().writeiorequest(0).direction(), fri::OUTPUT);
    EXPECT_EQ(answer.commanddata().writeiorequest(1).analogvalue(), 0.5);
  }
  EXPECT_EQ(Cycle(3).commanddata().writeiorequest_size(), 0) << "2 was lost, 3 arrived";
}

TEST_F(FriOutputsTest, FramesGoAlongWhereTheArmAsksForThem) {
  Cycle(0);
  FriTransformation cup{.name = FriName("cup")};
  Pose X = Pose::Identity();
  X.translation() << 0.001, 0.002, 0.003;
  cup.X = X;
  ASSERT_EQ(session_.Transform(cup), FriOutputError::kNone);
  for (int i = 0; i < 2; ++i) {
    const auto answer = Cycle(0);
    ASSERT_EQ(answer.commanddata().commandedtransformations_size(), 1);
    EXPECT_EQ(answer.commanddata().commandedtransformations(0).element(3), 1.0) << "mm";
  }
  asks_ = false;
  EXPECT_EQ(Cycle(0).commanddata().commandedtransformations_size(), 0);
}

// Ten outputs and five frames with the longest names exceed 1500 bytes; the motion fits.
TEST_F(FriSessionTest, WhatDoesNotFitBesideTheMotionIsLeftOut) {
  fri::FRIMonitoringMessage m = Monitoring(1, fri::COMMANDING_ACTIVE);
  const auto name = [](char kind, int i) { return std::string(62, kind) + static_cast<char>('0' + i); };
  for (int i = 0; i < 10; ++i) {
    auto* io = m.mutable_monitordata()->add_readiorequest();
    io->set_name(name('o', i));
    io->set_type(fri::BOOLEAN);
    io->set_direction(fri::OUTPUT);
  }
  ASSERT_EQ(session_.Accept(Bytes(m), 1, state_), FriAccept::kAccepted);
  for (int i = 0; i < 10; ++i)
    ASSERT_EQ(session_.Write({.name = FriName(name('o', i)), .digital = ~0ull}), FriOutputError::kNone);
  m = Monitoring(2, fri::COMMANDING_ACTIVE);
  for (int i = 0; i < 5; ++i) m.add_requestedtransformations()->set_name(name('f', i));
  ASSERT_EQ(session_.Accept(Bytes(m), 2, state_), FriAccept::kAccepted);
  for (int i = 0; i < 5; ++i)
    ASSERT_EQ(session_.Transform({.name = FriName(name('f', i))}), FriOutputError::kNone);
  const auto answer = Answer(Joints(0.9));
  EXPECT_EQ(Position(answer), Joints(0.9));
  EXPECT_EQ(answer.commanddata().writeiorequest_size(), 0);
  EXPECT_EQ(answer.commanddata().commandedtransformations_size(), 0);
}

}  // namespace
}  // namespace osteon::io
