#include "io/fri/fri_link.h"

#include <gtest/gtest.h>

#include "tests/io/fri/fri_oracle.h"
#include "tests/io/net/link_bench.h"
#include "tests/io/net/loopback_socket.h"

// FriLink over UDP on the loopback: the arm, unknown senders ("strangers"), silence, and several arms at
// once.

namespace osteon::io {
namespace {

using control::ArmCommand;
using control::ArmState;
using control::ReceiveResult;
using test::Bytes;
using test::Joints;
using test::Monitoring;
using test::Soon;

// A plain UDP socket that plays the arm or a stranger.
class Peer : public test::LoopbackSocket {
 public:
  explicit Peer(std::uint16_t port) { Connect(port); }

  void Send(const std::vector<std::uint8_t>& bytes) const { LoopbackSocket::Send(bytes); }
  void Send(std::uint32_t sequence, fri::SessionState state) const {
    Send(Bytes(Monitoring(sequence, state)));
  }
  // The next answer of the link; empty if there is none.
  [[nodiscard]] std::vector<std::uint8_t> Answer() const {
    return Receive().value_or(std::vector<std::uint8_t>{});
  }
};

std::unique_ptr<FriLink> OpenOnAnyPort() { return test::OpenOnAnyPort<FriLink>(); }

TEST(FriLink, AnswersTheArmAtTheAddressItSpokeFrom) {
  const auto link = OpenOnAnyPort();
  ASSERT_NE(link->port(), 0);
  const Peer arm(link->port());
  ArmState state;
  EXPECT_FALSE(link->Send(ArmCommand{})) << "never speaks first";
  arm.Send(1, fri::COMMANDING_ACTIVE);
  const rt::Nanoseconds before = rt::MonotonicNow() - rt::kSecond;
  ASSERT_EQ(link->Receive(state, Soon()), ReceiveResult::kOk);
  EXPECT_GT(state.stamp, before);
  EXPECT_LE(state.stamp, rt::MonotonicNow());
  ASSERT_TRUE(link->Send(ArmCommand{.q = Joints(0.31), .activation = state.activation}));
  const auto answer = test::Command(arm.Answer());
  ASSERT_TRUE(answer);
  EXPECT_EQ(test::Values(answer->commanddata().jointposition()), Joints(0.31));
  EXPECT_EQ(answer->header().reflectedsequencecounter(), 1u);
}

TEST(FriLink, TimesOutIfTheArmIsSilent) {
  const auto link = OpenOnAnyPort();
  ArmState state;
  EXPECT_EQ(link->Receive(state, rt::MonotonicNow() + rt::kMillisecond), ReceiveResult::kTimeout);
  EXPECT_EQ(link->Receive(state, 0), ReceiveResult::kTimeout) << "a deadline in the past";
}

TEST(FriLink, ReceivesTheNewestOfTheWaitingMessages) {
  const auto link = OpenOnAnyPort();
  const Peer arm(link->port());
  for (std::uint32_t i = 1; i <= 5; ++i) arm.Send(i, fri::COMMANDING_ACTIVE);
  ArmState state;
  ASSERT_EQ(link->Receive(state, 0), ReceiveResult::kOk)
      << "what has arrived is taken after the deadline too";
  EXPECT_EQ(state.sequence, 5u);
  EXPECT_EQ(state.late, 4u);
  EXPECT_EQ(state.lost, 0u);
  EXPECT_EQ(link->Receive(state, 0), ReceiveResult::kTimeout);
}

TEST(FriLink, SkipsHostileBytesAndCountsThem) {
  const auto link = OpenOnAnyPort();
  const Peer arm(link->port());
  arm.Send({});
  arm.Send(std::vector<std::uint8_t>(2000, 0x0a));
  arm.Send({0xff, 0xff});
  arm.Send(1, fri::MONITORING_READY);
  arm.Send({0xff, 0xff});
  ArmState state;
  ASSERT_EQ(link->Receive(state, Soon()), ReceiveResult::kOk);
  EXPECT_EQ(state.sequence, 1u);
  EXPECT_EQ(state.rejected, 4u);
}

TEST(FriLink, HearsAndAnswersTheFirstPeerOnly) {
  const auto link = OpenOnAnyPort();
  const Peer arm(link->port()), stranger(link->port());
  ArmState state;
  stranger.Send({1, 2, 3});  // an invalid datagram does not make its sender the peer
  arm.Send(1, fri::COMMANDING_ACTIVE);
  ASSERT_EQ(link->Receive(state, Soon()), ReceiveResult::kOk);
  stranger.Send(2, fri::COMMANDING_ACTIVE);
  arm.Send(3, fri::COMMANDING_ACTIVE);
  ASSERT_EQ(link->Receive(state, Soon()), ReceiveResult::kOk);
  EXPECT_EQ(state.sequence, 3u);
  EXPECT_EQ(state.lost, 1u) << "the stranger's 2 is not the arm's";
  EXPECT_EQ(state.rejected, 2u);
  ASSERT_TRUE(link->Send(ArmCommand{}));
  EXPECT_TRUE(stranger.Answer().empty());
  EXPECT_FALSE(arm.Answer().empty());
}

// 127.0.0.2 is the arm's configured address; the stranger sends from 127.0.0.1.
TEST(FriLink, HearsOnlyTheConfiguredAddress) {
  auto link = FriLink::Open({.arm_address = "127.0.0.2", .port = 0});
  ASSERT_TRUE(link) << link.error();
  const Peer stranger((*link)->port());
  stranger.Send(1, fri::COMMANDING_ACTIVE);  // a valid message, and the first one to arrive
  ArmState state;
  EXPECT_EQ((*link)->Receive(state, rt::MonotonicNow() + 20 * rt::kMillisecond), ReceiveResult::kTimeout);
  EXPECT_EQ(state.rejected, 1u);
  EXPECT_FALSE((*link)->Send(ArmCommand{})) << "and gets no answer";
  EXPECT_FALSE(FriLink::Open({.arm_address = "the arm", .port = 0}));
}

TEST(FriLink, NoiseAfterASilenceDoesNotEndTheSession) {
  const auto link = OpenOnAnyPort();
  const Peer arm(link->port()), stranger(link->port());
  ArmState state;
  arm.Send(5000, fri::COMMANDING_ACTIVE);
  ASSERT_EQ(link->Receive(state, Soon()), ReceiveResult::kOk);
  rt::SleepUntil(rt::MonotonicNow() + rt::kSecond + 50 * rt::kMillisecond);
  stranger.Send({1, 2, 3});
  arm.Send(5010, fri::COMMANDING_ACTIVE);
  ASSERT_EQ(link->Receive(state, Soon()), ReceiveResult::kOk);
  EXPECT_EQ(state.lost, 9u) << "the arm's session went on";
}

TEST(FriLink, AcceptsANewPeerAfterASecondOfSilence) {
  const auto link = OpenOnAnyPort();
  ArmState state;
  {
    const Peer arm(link->port());
    arm.Send(5000, fri::COMMANDING_ACTIVE);
    ASSERT_EQ(link->Receive(state, Soon()), ReceiveResult::kOk);
  }
  rt::SleepUntil(rt::MonotonicNow() + rt::kSecond + 50 * rt::kMillisecond);
  const Peer restarted(link->port());
  restarted.Send(1, fri::MONITORING_WAIT);
  ASSERT_EQ(link->Receive(state, Soon()), ReceiveResult::kOk);
  EXPECT_EQ(state.sequence, 1u);
  ASSERT_TRUE(link->Send(ArmCommand{}));
  EXPECT_EQ(restarted.Answer().size(), 77u);
}

TEST(FriLink, OpenErrorsNameTheWrongAddressOrPort) {
  test::ExpectAddressErrors<FriLink, FriLinkParams>("FRI");
}

// Each arm has its own link and its own port.
TEST(FriLink, SeveralArmsOfDifferentVersionsDoNotDisturbEachOther) {
  struct Arm {
    FriVersion version;
    std::unique_ptr<FriLink> link;
    std::unique_ptr<Peer> peer;
  };
  std::vector<Arm> arms;
  for (const FriVersion version : kFriVersions) {
    auto link = FriLink::Open({.port = 0, .session = {.version = version}});
    ASSERT_TRUE(link) << link.error();
    const std::uint16_t port = (*link)->port();
    arms.push_back({version, std::move(*link), std::make_unique<Peer>(port)});
  }
  for (std::uint32_t cycle = 1; cycle <= 3; ++cycle) {
    for (const Arm& arm : arms)
      arm.peer->Send(test::Datagram(FamilyOf(arm.version),
                                    Monitoring(cycle, fri::COMMANDING_ACTIVE, FamilyOf(arm.version))));
    for (std::size_t i = 0; i < arms.size(); ++i) {
      ArmState state;
      ASSERT_EQ(arms[i].link->Receive(state, Soon()), ReceiveResult::kOk) << Name(arms[i].version);
      EXPECT_EQ(state.sequence, cycle);
      const double first_rad = 0.3 + 1e-3 * static_cast<double>(i);
      ASSERT_TRUE(arms[i].link->Send({.q = Joints(first_rad), .activation = state.activation}));
      const auto answer = test::Command(arms[i].peer->Answer(), FamilyOf(arms[i].version));
      ASSERT_TRUE(answer) << Name(arms[i].version);
      EXPECT_EQ(test::Values(answer->commanddata().jointposition()), Joints(first_rad));
    }
  }
}

TEST(FriLink, ReportsThatTheArmSpeaksAnotherVersion) {
  const auto link = OpenOnAnyPort();
  const Peer arm(link->port());
  for (std::uint32_t i = 1; i <= 3; ++i)
    arm.Send(test::Datagram(FriFamily::k2_7, Monitoring(i, fri::MONITORING_WAIT, FriFamily::k2_7)));
  ArmState state;
  EXPECT_EQ(link->Receive(state, 0), ReceiveResult::kTimeout);
  EXPECT_EQ(state.other_version, 3u);
  EXPECT_NE(link->session().Diagnosis().find("The arm speaks FRI 2.7 (framed), configured is 1.15"),
            std::string::npos)
      << link->session().Diagnosis();
}

// One of two links calls WarmUp() after each answer. Both arms must get the same answers and nothing else.
TEST(FriLink, WarmUpChangesNoAnswerAndSendsNothing) {
  const auto link = OpenOnAnyPort(), plain = OpenOnAnyPort();
  const Peer arm(link->port()), plain_arm(plain->port());
  ArmState state, plain_state;
  link->WarmUp(ArmCommand{});  // before the arm's first message
  for (std::uint32_t i = 1; i <= 50; ++i) {
    const auto session = i < 5 ? fri::COMMANDING_WAIT : fri::COMMANDING_ACTIVE;
    arm.Send(i, session);
    plain_arm.Send(i, session);
    ASSERT_EQ(link->Receive(state, Soon()), ReceiveResult::kOk);
    ASSERT_EQ(plain->Receive(plain_state, Soon()), ReceiveResult::kOk);
    EXPECT_EQ(state.sequence, plain_state.sequence);
    EXPECT_EQ(state.duplicate + state.rejected + state.lost, 0u);
    const ArmCommand command{.q = Joints(0.001 * i), .activation = state.activation};
    ASSERT_TRUE(link->Send(command));
    ASSERT_TRUE(plain->Send(command));
    EXPECT_EQ(arm.Answer(), plain_arm.Answer()) << i;
    rt::CheckedNoAllocScope no_alloc;
    link->WarmUp(command);
  }
  EXPECT_EQ(arm.Answer(), std::vector<std::uint8_t>{}) << "nothing more";
}

TEST(FriLink, AwaitEndsAtItsDeadlineAndTakesNoMessage) {
  const auto link = OpenOnAnyPort();
  const rt::Nanoseconds until = rt::MonotonicNow() + 2 * rt::kMillisecond;
  EXPECT_FALSE(link->Await(until));
  EXPECT_GE(rt::MonotonicNow(), until);
  const Peer arm(link->port());
  arm.Send(1, fri::COMMANDING_ACTIVE);
  EXPECT_TRUE(link->Await(Soon()));
  ArmState state;
  EXPECT_EQ(link->Receive(state, 0), ReceiveResult::kOk) << "and it is still there";
}

TEST(FriLink, DoesNotAllocate) {
  const auto link = OpenOnAnyPort();
  const Peer arm(link->port());
  arm.Send(1, fri::COMMANDING_ACTIVE);
  test::ExpectNoAllocation(*link);
}

}  // namespace
}  // namespace osteon::io
