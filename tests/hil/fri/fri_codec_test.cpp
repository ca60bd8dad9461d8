#include "hil/fri/fri_codec.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/hil/test_client.h"
#include "tests/io/fri/fri_golden.h"

// Tests how the simulated arm encodes monitoring messages and decodes commands, in each version of FRI. A
// field is named by its path of protobuf numbers: {5, 10} is field 10 within field 5.

namespace osteon::hil {
namespace {

// A message with a different number in each field.
FriMonitoring Example() {
  FriMonitoring m;
  m.sequence = 9;
  m.reflected_sequence = 8;
  m.session = control::SessionState::kMonitoringReady;
  m.quality = 3;
  m.send_period_ms = 5;
  m.receive_multiplier = 2;
  for (std::size_t i = 0; i < 7; ++i) {
    const double v = static_cast<double>(i);
    m.q_meas[i] = 0.1 + v, m.tau_meas[i] = 0.2 + v, m.q_cmd[i] = 0.3 + v, m.tau_cmd[i] = 0.4 + v;
    m.tau_ext[i] = 0.5 + v, m.q_ipo[i] = 0.6 + v;
  }
  m.tracking_performance = 0.75;
  m.stamp = 1'600'000'000 * rt::kSecond + 123'456'789;
  return m;
}

std::vector<double> Vector(const control::JointArray& a) { return {a.begin(), a.end()}; }

// Real arms with version 1.15 send 401 bytes. In the commanding states they send 466 bytes, because the
// interpolator's position is added.
TEST(FriCodec, AMonitoringMessageHasTheSizeSeenOnRealArms) {
  FriCodec codec;
  FriMonitoring m = Example();
  EXPECT_EQ(codec.Encode(m).size(), 401u);
  m.has_ipo = true;
  EXPECT_EQ(codec.Encode(m).size(), 466u);
}

TEST(FriCodec, WritesEveryFieldUnderItsNumber) {
  FriCodec codec;
  FriMonitoring m = Example();
  m.has_ipo = true;
  const auto bytes = codec.Encode(m);
  EXPECT_EQ(UintAt(bytes, {1, 1}), 0x245142u);
  EXPECT_EQ(UintAt(bytes, {1, 2}), 9u);
  EXPECT_EQ(UintAt(bytes, {1, 3}), 8u);
  EXPECT_EQ(UintAt(bytes, {2, 1}), 7u);
  EXPECT_EQ(UintAt(bytes, {2, 2}), 0u);
  ASSERT_EQ(At(bytes, {2, 5}).size(), 7u);  // the values are not packed: each drive has a tag of its own
  for (const Field& drive : At(bytes, {2, 5})) EXPECT_EQ(drive.value, 2u);
  EXPECT_EQ(UintAt(bytes, {2, 6}), 2u);
  EXPECT_EQ(UintAt(bytes, {2, 7}), 0u);
  EXPECT_EQ(DoublesAt(bytes, {3, 1, 1}), Vector(m.q_meas));
  EXPECT_EQ(DoublesAt(bytes, {3, 2, 1}), Vector(m.tau_meas));
  EXPECT_EQ(DoublesAt(bytes, {3, 3, 1}), Vector(m.q_cmd));
  EXPECT_EQ(DoublesAt(bytes, {3, 4, 1}), Vector(m.tau_cmd));
  EXPECT_EQ(DoublesAt(bytes, {3, 5, 1}), Vector(m.tau_ext));
  EXPECT_EQ(UintAt(bytes, {3, 15, 1}), 1'600'000'000u);
  EXPECT_EQ(UintAt(bytes, {3, 15, 2}), 123'456'789u);
  EXPECT_EQ(UintAt(bytes, {4, 1}), 2u);
  EXPECT_EQ(UintAt(bytes, {4, 2}), 3u);
  EXPECT_EQ(UintAt(bytes, {4, 3}), 5u);
  EXPECT_EQ(UintAt(bytes, {4, 4}), 2u);
  EXPECT_EQ(DoublesAt(bytes, {5, 1, 1}), Vector(m.q_ipo));
  EXPECT_EQ(UintAt(bytes, {5, 10}), 1u);
  EXPECT_EQ(UintAt(bytes, {5, 11}), 1u);
  EXPECT_EQ(DoublesAt(bytes, {5, 12}), std::vector<double>{0.75});
}

TEST(FriCodec, WritesTheInterpolatorsPositionOnlyInCommandingStates) {
  FriCodec codec;
  FriMonitoring m = Example();
  m.has_ipo = true;
  EXPECT_EQ(DoublesAt(codec.Encode(m), {5, 1, 1}).size(), 7u);
  m.has_ipo = false;
  EXPECT_TRUE(At(codec.Encode(m), {5, 1}).empty());
}

// The bytes of a published command with counter 8: the header, then seven joints, 77 bytes in all.
TEST(FriCodec, ReadsThePublishedCommand) {
  Bytes bytes{0x0a, 0x08, 0x08, 0x81, 0x80, 0x0d, 0x10, 0x08, 0x18, 0x08, 0x12, 0x41, 0x0a, 0x3f};
  for (int i = 0; i < 7; ++i) PutDouble(bytes, 1, 0.25 * i);
  ASSERT_EQ(bytes.size(), 77u);
  EXPECT_EQ(bytes, Command(8, 8,
                           {0, .25, .5, .75, 1, 1.25,
                            1.5}));  // the test client encodes the same command to the same bytes
  const auto command = FriCodec().Decode(bytes);
  ASSERT_TRUE(command);
  EXPECT_EQ(command->sequence, 8u);
  EXPECT_EQ(command->reflected_sequence, 8u);
  ASSERT_TRUE(command->has_joint_position);
  EXPECT_EQ(command->joint_count, 7);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(command->q[i], 0.25 * static_cast<double>(i));
}

namespace golden = io::test::golden;

// Commands recorded as bytes: without a frame, and for 2.7 with a frame.
TEST(FriCodec, ReadsCommandsOfEveryVersion) {
  for (const io::FriVersion version : io::kFriVersions) {
    SCOPED_TRACE(Name(version));
    const bool framed = version == io::FriVersion::k2_7;
    FriCodec codec(version);
    const auto header =
        codec.Decode(golden::FromHex(framed ? golden::kHeaderOnlyFramed : golden::kHeaderOnly));
    ASSERT_TRUE(header);
    EXPECT_FALSE(header->has_joint_position || header->has_wrench || header->has_torque);
    const Bytes wrench = golden::FromHex(framed ? golden::kPositionWrenchFramed : golden::kPositionWrench);
    const auto command = codec.Decode(wrench);
    ASSERT_TRUE(command);
    EXPECT_EQ(command->sequence, 8u);
    EXPECT_EQ(command->q[6], 1.25);
    ASSERT_TRUE(command->has_wrench);
    EXPECT_EQ(command->wrench_count, 6);
    EXPECT_EQ(command->wire_wrench, (std::array<double, 6>{1, 2, 3, 4, 5, 6}));
    EXPECT_FALSE(command->has_torque);
    // if the framing is that of another version, the codec must refuse the command and recognise the reason
    const Bytes other = golden::FromHex(framed ? golden::kPositionWrench : golden::kPositionWrenchFramed);
    EXPECT_FALSE(codec.Decode(other));
    EXPECT_TRUE(codec.IsOfOtherVersion(other));
    EXPECT_FALSE(codec.IsOfOtherVersion(Bytes{1, 2, 3}));
    if (!framed) continue;
    for (std::size_t i = 0; i < wrench.size(); ++i) {
      Bytes damaged = wrench;
      damaged[i] ^= 1;
      EXPECT_FALSE(codec.Decode(damaged)) << i;
    }
  }
  const auto torque = FriCodec().Decode(golden::FromHex(golden::kPositionTorque));
  ASSERT_TRUE(torque && torque->has_torque);
  EXPECT_EQ(torque->torque_count, 7);
  EXPECT_EQ(torque->tau[0], 1.0);
}

TEST(FriCodec, WritesTheFieldsThatEachVersionHas) {
  for (const io::FriVersion version : io::kFriVersions) {
    SCOPED_TRACE(Name(version));
    const io::FriFamily family = io::FamilyOf(version);
    const bool framed = family == io::FriFamily::k2_7, has_poses = family != io::FriFamily::k1;
    FriCodec codec(version);
    FriMonitoring m = Example();
    m.has_ipo = true;
    m.command_mode = control::CommandMode::kTorque;
    m.wire_force = {1, 2, 3, 4, 5, 6};
    auto bytes = codec.Encode(m);
    if (framed) bytes = bytes.subspan(4, bytes.size() - 8);
    EXPECT_EQ(At(bytes, {3, 3}).size(), has_poses ? 0u : 1u);
    EXPECT_EQ(At(bytes, {3, 6}).size(), framed ? 1u : 0u);
    EXPECT_EQ(At(bytes, {3, 9}).size(), has_poses ? 1u : 0u);
    EXPECT_EQ(At(bytes, {3, 10}).size(), has_poses ? 1u : 0u);
    EXPECT_EQ(At(bytes, {5, 2}).size(), has_poses ? 1u : 0u);
    EXPECT_EQ(At(bytes, {5, 3}).size(), has_poses ? 1u : 0u);
    EXPECT_EQ(UintAt(bytes, {5, 10}), 3u);
  }
}

TEST(FriCodec, AcceptsACommandWithoutJoints) {
  const auto command = FriCodec().Decode(Command(1, 2, {}));
  ASSERT_TRUE(command);
  EXPECT_FALSE(command->has_joint_position);
}

TEST(FriCodec, RefusesBytesThatAreNoCommand) {
  FriCodec codec;
  const std::vector<double> q(7, 0.5);
  const Bytes good = Command(8, 8, q);
  ASSERT_TRUE(codec.Decode(good));
  EXPECT_FALSE(codec.Decode({}));
  EXPECT_FALSE(codec.Decode(Command(8, 8, q, 0x245142)));                             // a monitoring message
  EXPECT_FALSE(codec.Decode(Bytes(good.begin() + 10, good.end())));                   // the header is missing
  EXPECT_FALSE(codec.Decode(Bytes{0x0a, 0x06, 0x08, 0x81, 0x80, 0x0d, 0x10, 0x08}));  // no reflected counter
  EXPECT_FALSE(codec.Decode(Bytes(1501, 0)));
  Bytes framed{77, 0, 0, 0};  // in 2.7 a length precedes the message
  framed.insert(framed.end(), good.begin(), good.end());
  EXPECT_FALSE(codec.Decode(framed));
  for (std::size_t n = 1; n < good.size(); ++n) {
    if (n == 10) continue;  // the header alone is a valid answer without joints
    EXPECT_FALSE(codec.Decode(Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(n)))) << n;
  }
}

TEST(FriCodec, RefusesRandomBytesWithoutLastingEffect) {
  FriCodec codec;
  std::mt19937 random(20240607);
  const Bytes good = Command(8, 8, std::vector<double>(7, 0.5));
  int accepted = 0;
  for (int i = 0; i < 20000; ++i) {
    Bytes bytes;
    if (i % 2 == 0) {
      bytes.resize(random() % 1600);
      for (auto& b : bytes) b = static_cast<std::uint8_t>(random());
    } else {
      bytes = good;
      for (unsigned k = random() % 4; k <= 4; ++k)
        bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    }
    accepted += codec.Decode(bytes) ? 1 : 0;
  }
  EXPECT_GT(accepted, 100) << "where a changed byte lies in a number, it is a message";
  EXPECT_LT(accepted, 10'000) << "noise is none";
  ASSERT_TRUE(codec.Decode(good));  // the refused messages must leave no state in the codec
  EXPECT_EQ(codec.Decode(good)->joint_count, 7);
}

}  // namespace
}  // namespace osteon::hil
