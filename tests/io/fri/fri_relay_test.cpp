#include "io/fri/fri_relay.h"

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"
#include "tests/io/fri/fri_oracle.h"
#include "tests/io/net/loopback_socket.h"
#include "tests/kinematics/iiwa14.h"

// The guard's relay between arm and controller passes on only the datagrams that the guard's monitor permits.

namespace osteon::io {
namespace {

using test::Datagram;
using test::Monitoring;
using Bytes = std::vector<std::uint8_t>;

// Arm, relay and controller on the loopback. Arm and controller are plain sockets; libprotobuf encodes and
// decodes their messages.
class Line {
 public:
  explicit Line(FriVersion version = FriVersion::k1_15) : family_(FamilyOf(version)) {
    safety::GuardParams params{.arm = kinematics::ChainFrom(kinematics::Iiwa14())};
    params.max_tracking_error_m = 10.0;  // the measured pose in these messages is arbitrary
    params.workspace.sphere_radius_m = 10.0;
    params.workspace.plane_offset_m = -10.0;
    params.answer_age_s = params.silence_s = 3600.0;  // so that no test depends on how busy the machine is
    monitor_.emplace(params);
    auto opened =
        FriRelay::Open({.arm_port = 0, .controller_port = controller.port(), .version = version}, *monitor_);
    EXPECT_TRUE(opened) << opened.error();
    relay_ = std::move(*opened);
    arm.Connect(relay_->port());
  }

  /// Sends a message of the arm; returns the datagram that the controller receives.
  std::optional<Bytes> SendMessage(std::uint32_t sequence, fri::SessionState state) {
    arm.Send(Datagram(family_, Monitoring(sequence, state, family_)));
    return ReceiveRelayed(controller);
  }
  /// Sends an answer of the controller; returns the datagram that the arm receives.
  std::optional<Bytes> SendAnswer(const Bytes& bytes) {
    controller.SendTo(relay_port_, bytes);
    return ReceiveRelayed(arm);
  }
  /// A command that answers message `reflected`, with joints from `first` [rad].
  Bytes Command(std::uint32_t reflected, double first) const {
    fri::FRICommandMessage m;
    m.mutable_header()->set_messageidentifier(0x34001);
    m.mutable_header()->set_sequencecounter(reflected);
    m.mutable_header()->set_reflectedsequencecounter(reflected);
    test::PutJoints(first, m.mutable_commanddata()->mutable_jointposition());
    return Datagram(family_, m);
  }
  /// Finds the port from which the relay sends to the controller: relays a first message of the arm.
  void LearnRelayPort() {
    arm.Send(Datagram(family_, Monitoring(0, fri::MONITORING_READY, family_)));
    EXPECT_TRUE(relay_->Serve(0));
    relay_port_ = controller.ReceiveFrom();  // takes the message
    ASSERT_NE(relay_port_, 0);
  }
  [[nodiscard]] std::uint16_t relay_port() const { return relay_port_; }
  FriRelay& relay() { return *relay_; }
  safety::GuardMonitor& monitor() { return *monitor_; }

  test::LoopbackSocket arm, controller;

 private:
  // Lets the relay serve once; returns the datagram that `to` receives, if any.
  std::optional<Bytes> ReceiveRelayed(const test::LoopbackSocket& to) {
    EXPECT_TRUE(relay_->Serve(0));
    return to.Receive();
  }
  FriFamily family_;
  std::optional<safety::GuardMonitor> monitor_;
  std::unique_ptr<FriRelay> relay_;
  std::uint16_t relay_port_{0};
};

TEST(FriRelay, CarriesEveryFamilyBothWaysBitForBit) {
  for (const FriVersion version : {FriVersion::k1_15, FriVersion::k2_5, FriVersion::k2_7}) {
    SCOPED_TRACE(Name(version));
    Line line(version);
    line.LearnRelayPort();
    const FriFamily family = FamilyOf(version);
    for (std::uint32_t i = 1; i < 20; ++i) {
      const auto state = i < 5    ? fri::MONITORING_READY
                         : i < 10 ? fri::COMMANDING_WAIT
                                  : fri::COMMANDING_ACTIVE;
      EXPECT_EQ(line.SendMessage(i, state), Datagram(family, Monitoring(i, state, family)));
      const Bytes answer = line.Command(i, 0.3);
      EXPECT_EQ(line.SendAnswer(answer), answer) << safety::Describe(line.monitor().reason());
    }
    EXPECT_EQ(line.relay().counters().to_controller, 20u);
    EXPECT_EQ(line.relay().counters().to_arm, 19u);
    EXPECT_EQ(line.relay().message_delay().count(), 20u);
    EXPECT_EQ(line.relay().answer_delay().count(), 19u);
    EXPECT_TRUE(line.monitor().permits());
  }
}

TEST(FriRelay, AnswersThatTheMonitorWithholdsNeverReachTheArm) {
  Line line;
  line.LearnRelayPort();
  ASSERT_TRUE(line.SendMessage(1, fri::COMMANDING_WAIT));
  ASSERT_TRUE(line.SendAnswer(line.Command(1, 0.3)));
  ASSERT_TRUE(line.SendMessage(2, fri::COMMANDING_ACTIVE));
  EXPECT_FALSE(line.SendAnswer(line.Command(2, 0.4))) << "a jump";
  EXPECT_EQ(line.monitor().reason().finding, safety::GuardFinding::kJointSpeed);
  EXPECT_TRUE(line.SendMessage(3, fri::COMMANDING_ACTIVE))
      << "the controller may still see what the arm does";
  EXPECT_FALSE(line.SendAnswer(line.Command(3, 0.3)));
  EXPECT_EQ(line.relay().counters().to_arm, 1u);
}

TEST(FriRelay, ADatagramThatIsNoCommandIsWithheldAndLatchesTheFinding) {
  Line line;
  line.LearnRelayPort();
  ASSERT_TRUE(line.SendMessage(1, fri::MONITORING_READY));
  EXPECT_FALSE(line.SendAnswer({1, 2, 3}));
  EXPECT_EQ(line.monitor().reason().finding, safety::GuardFinding::kUnreadable);
  Line framed(FriVersion::k2_7);
  framed.LearnRelayPort();
  ASSERT_TRUE(framed.SendMessage(1, fri::MONITORING_READY));
  Bytes damaged = framed.Command(1, 0.3);
  damaged[10] ^= 1;
  EXPECT_FALSE(framed.SendAnswer(damaged));
  EXPECT_EQ(framed.monitor().reason().finding, safety::GuardFinding::kChecksum);
}

TEST(FriRelay, HearsOnlyTheArmAndTheController) {
  Line line;
  line.LearnRelayPort();
  const test::LoopbackSocket stranger;
  stranger.SendTo(line.relay().port(), Datagram(FriFamily::k1, Monitoring(50, fri::MONITORING_READY)));
  EXPECT_TRUE(line.relay().Serve(0));
  EXPECT_FALSE(line.controller.Receive());
  EXPECT_EQ(line.relay().counters().rejected, 1u);
  line.arm.Send(Bytes{1, 2, 3});
  EXPECT_TRUE(line.relay().Serve(0));
  EXPECT_FALSE(line.controller.Receive()) << "no message of this version";
  EXPECT_EQ(line.relay().counters().rejected, 2u);

  ASSERT_TRUE(line.SendMessage(1, fri::MONITORING_READY));
  stranger.SendTo(line.relay_port(), line.Command(1, 0.3));
  EXPECT_TRUE(line.relay().Serve(0));
  EXPECT_FALSE(line.arm.Receive());
  EXPECT_TRUE(line.monitor().permits()) << "not the controller's doing";
}

TEST(FriRelay, OpenErrorsNameTheWrongAddressOrPort) {
  const Line line;
  safety::GuardMonitor monitor({.arm = kinematics::ChainFrom(kinematics::Iiwa14())});
  const auto expect = [&](const FriRelayParams& params, const std::string& text) {
    const auto relay = FriRelay::Open(params, monitor);
    ASSERT_FALSE(relay);
    EXPECT_NE(relay.error().find(text), std::string::npos) << relay.error();
  };
  expect({.arm_port = line.controller.port()},
         "guard: UDP 127.0.0.1:" + std::to_string(line.controller.port()) + " is taken");
  expect({.arm_address = "arm", .arm_port = 0}, "'arm' is not an IPv4 address");
  expect({.arm_port = 0, .controller_address = "pc"}, "'pc' is not an IPv4 address");
}

TEST(FriRelay, DoesNotAllocate) {
  Line line;
  line.LearnRelayPort();
  line.arm.Send(Datagram(FriFamily::k1, Monitoring(1, fri::MONITORING_READY)));
  line.controller.SendTo(line.relay_port(), line.Command(0, 0.3));
  rt::CheckedNoAllocScope no_alloc;
  (void)line.relay().Serve(0);
}

}  // namespace
}  // namespace osteon::io
