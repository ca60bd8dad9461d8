#include "io/fri/command_reader.h"

#include <cmath>
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "io/fri/codec.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/io/fri/fri_golden.h"
#include "tests/io/fri/fri_oracle.h"

// Tests the guard's reader of the commands that a controller sends to its arm.

namespace osteon::io {
namespace {

using test::golden::FromHex;

constexpr std::array kFamilies{FriFamily::k1, FriFamily::k2_5, FriFamily::k2_7};

// The datagram that the controller sends for this command.
std::vector<std::uint8_t> EncodedCommand(FriFamily family, const CommandMessage& message) {
  std::vector<std::uint8_t> bytes(kFriMaxDatagram);
  std::size_t size = 0;
  EXPECT_EQ(EncodeCommand(family, message, bytes, size), CodecError::kNone);
  bytes.resize(size);
  return bytes;
}

// A command with joint positions only.
fri::FRICommandMessage PositionCommand() {
  fri::FRICommandMessage m;
  m.mutable_header()->set_messageidentifier(0x34001);
  m.mutable_header()->set_sequencecounter(8);
  m.mutable_header()->set_reflectedsequencecounter(9);
  test::PutJoints(0.5, m.mutable_commanddata()->mutable_jointposition());
  return m;
}

// The error of ReadCommand for this message.
FriCommandError Read(const google::protobuf::MessageLite& message, FriFamily family = FriFamily::k1) {
  FriReadCommand command;
  return ReadCommand(family, test::Datagram(family, message), command);
}

TEST(FriCommandReader, ReadsTheGoldenDatagrams) {
  FriReadCommand command;
  ASSERT_EQ(ReadCommand(FriFamily::k1, FromHex(test::golden::kPositionWrench), command),
            FriCommandError::kNone);
  EXPECT_EQ(command.sequence, 8u);
  EXPECT_EQ(command.reflected_sequence, 8u);
  EXPECT_EQ(command.q, test::Joints(0.5));
  EXPECT_EQ(command.wrench, (std::array<double, 6>{1, 2, 3, 4, 5, 6}));
  EXPECT_FALSE(command.tau || command.cartesian);
  ASSERT_EQ(ReadCommand(FriFamily::k1, FromHex(test::golden::kPositionTorque), command),
            FriCommandError::kNone);
  EXPECT_EQ(command.tau, test::Joints(1.0));
  ASSERT_EQ(ReadCommand(FriFamily::k2_5, FromHex(test::golden::kHeaderOnly), command),
            FriCommandError::kNone);
  EXPECT_FALSE(command.q || command.wrench || command.tau);
  ASSERT_EQ(ReadCommand(FriFamily::k2_7, FromHex(test::golden::kPositionWrenchFramed), command),
            FriCommandError::kNone);
  EXPECT_EQ(command.q, test::Joints(0.5));
}

TEST(FriCommandReader, ReadsTheControllersCommandsInEveryFamily) {
  for (const FriFamily family : kFamilies) {
    CommandMessage message{.sequence = 4'000'000'000u, .reflected_sequence = 7, .q = test::Joints(-1e-300)};
    message.wire_wrench = {1.5, -2.5, 1e308, 0.0, -0.0, 3.0};
    message.tau = test::Joints(3.0);
    message.X = FriPose{.name = FriName("flange"), .element = {1, 2, 3, 1, 0, 0, 0}};
    FriReadCommand command;
    ASSERT_EQ(ReadCommand(family, EncodedCommand(family, message), command), FriCommandError::kNone)
        << Describe(family);
    EXPECT_EQ(command.sequence, message.sequence);
    EXPECT_EQ(command.reflected_sequence, 7u);
    EXPECT_EQ(command.q, message.q);
    EXPECT_EQ(command.wrench, message.wire_wrench);
    EXPECT_EQ(command.tau, message.tau);
    EXPECT_EQ(command.cartesian, family != FriFamily::k1);
  }
}

// The guard and the arm must not read different commands from the same datagram. Therefore the guard must
// refuse a datagram that can be read in two ways.
TEST(FriCommandReader, RefusesDatagramsThatAnArmMightReadDifferently) {
  EXPECT_EQ(Read(PositionCommand()), FriCommandError::kNone);
  auto twice = test::Bytes(PositionCommand());
  const auto again = twice;
  twice.insert(twice.end(), again.begin(),
               again.end());  // protobuf merges both parts, which gives fourteen joints
  FriReadCommand command;
  EXPECT_EQ(ReadCommand(FriFamily::k1, twice, command), FriCommandError::kMalformed);

  auto m = PositionCommand();
  m.mutable_commanddata()->mutable_jointposition()->add_value(0.0);
  EXPECT_EQ(Read(m), FriCommandError::kMalformed) << "eight joints";
  m = PositionCommand();
  m.mutable_commanddata()->mutable_cartesianwrenchfeedforward()->add_element(1.0);
  EXPECT_EQ(Read(m), FriCommandError::kMalformed) << "a wrench of one";
  m = PositionCommand();
  m.mutable_header()->set_messageidentifier(0x245142);
  EXPECT_EQ(Read(m), FriCommandError::kMalformed) << "a monitoring message";
  m = PositionCommand();
  m.mutable_header()->clear_reflectedsequencecounter();
  EXPECT_EQ(Read(m), FriCommandError::kMalformed);
  m = PositionCommand();
  test::PutPose(m.mutable_commanddata()->mutable_cartesianpose());
  EXPECT_EQ(Read(m, FriFamily::k1), FriCommandError::kMalformed) << "1.x has no poses";
  EXPECT_EQ(Read(m, FriFamily::k2_5), FriCommandError::kNone);

  auto bytes = test::Bytes(PositionCommand());
  bytes.insert(bytes.end(), {0x98, 0x06, 0x01});  // field 99 with a varint
  EXPECT_EQ(ReadCommand(FriFamily::k1, bytes, command), FriCommandError::kMalformed);
  EXPECT_EQ(ReadCommand(FriFamily::k1, {}, command), FriCommandError::kMalformed);
  EXPECT_EQ(ReadCommand(FriFamily::k1, std::vector<std::uint8_t>(1501, 0), command),
            FriCommandError::kMalformed);
  EXPECT_EQ(ReadCommand(FriFamily::k2_7, test::Bytes(PositionCommand()), command),
            FriCommandError::kMalformed)
      << "bare";
  auto framed = test::Datagram(FriFamily::k2_7, PositionCommand());
  framed[20] ^= 1;
  EXPECT_EQ(ReadCommand(FriFamily::k2_7, framed, command), FriCommandError::kChecksum);
}

// If the guard accepts a damaged datagram, libprotobuf must read the same joints, wrench, torques and
// counters from it, or must refuse it.
TEST(FriCommandReader, LibprotobufReadsTheSameFromEachAcceptedDatagram) {
  google::protobuf::SetLogHandler(nullptr);
  std::mt19937 random(20261122);
  auto full = PositionCommand();
  for (int i = 0; i < 6; ++i)
    full.mutable_commanddata()->mutable_cartesianwrenchfeedforward()->add_element(i);
  test::PutJoints(3.0, full.mutable_commanddata()->mutable_jointtorque());
  const std::vector<std::uint8_t> whole = test::Bytes(full);
  int taken = 0, changed = 0, refused = 0;
  for (int run = 0; run < 200'000; ++run) {
    std::vector<std::uint8_t> bytes = whole;
    for (int i = static_cast<int>(random() % 3); i >= 0; --i) {
      const std::size_t at = random() % bytes.size();
      switch (random() % 3) {
        case 0:
          bytes[at] = static_cast<std::uint8_t>(random());
          break;
        case 1:
          bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(at));
          break;
        default:
          bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), static_cast<std::uint8_t>(random()));
      }
    }
    FriReadCommand command{.sequence = 77};
    if (ReadCommand(FriFamily::k1, bytes, command) != FriCommandError::kNone) {
      ASSERT_EQ(command.sequence, 77u) << "changed on kNone only";
      continue;
    }
    ++taken;
    changed += bytes != whole;
    const auto oracle = test::Command(bytes);
    // the damage is in a part that the guard does not read (a frame or an output); an arm refuses such a
    // datagram as a whole
    if (!oracle) {
      ++refused;
      continue;
    }
    ASSERT_EQ(oracle->header().sequencecounter(), command.sequence);
    ASSERT_EQ(oracle->header().reflectedsequencecounter(), command.reflected_sequence);
    const fri::MessageCommandData& data = oracle->commanddata();
    const auto same = [&](const auto& values, bool has, const auto& read) {
      ASSERT_EQ(has, read.has_value()) << "run " << run;
      if (!has) return;
      ASSERT_EQ(values.size(), static_cast<int>(read->size()));
      ASSERT_EQ(std::memcmp(values.data(), read->data(), sizeof *read), 0) << "bit for bit, NaN too";
    };
    same(data.jointposition().value(), data.has_jointposition(), command.q);
    same(data.cartesianwrenchfeedforward().element(), data.has_cartesianwrenchfeedforward(), command.wrench);
    same(data.jointtorque().value(), data.has_jointtorque(), command.tau);
  }
  EXPECT_GT(changed, 10'000) << "nothing was tested";
  EXPECT_LT(taken, 200'000);
  EXPECT_LT(refused, taken / 100);
}

TEST(FriCommandReader, DoesNotAllocate) {
  const auto bytes = FromHex(test::golden::kPositionWrenchFramed);
  FriReadCommand command;
  rt::CheckedNoAllocScope no_alloc;
  (void)ReadCommand(FriFamily::k2_7, bytes, command);
}

}  // namespace
}  // namespace osteon::io
