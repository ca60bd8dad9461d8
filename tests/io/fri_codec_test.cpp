#include "io/fri/codec.h"

#include <algorithm>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "control/rt/no_alloc_scope.h"
#include "tests/io/fri_oracle.h"

namespace osteon::io {
namespace {

using control::SessionState;
using test::Bytes;
using test::Joints;
using test::Monitoring;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

std::vector<std::uint8_t> Encoded(const CommandMessage& message) {
  std::vector<std::uint8_t> buffer(kFriMaxDatagram);
  std::size_t size = 0;
  EXPECT_EQ(EncodeCommand(message, buffer, size), CodecError::kNone);
  buffer.resize(size);
  return buffer;
}

CodecError ErrorOf(const std::vector<std::uint8_t>& datagram) {
  MonitoringMessage message;
  return DecodeMonitoring(datagram, message);
}

// Golden: sizes and bytes seen on a real 1.15 connection (design notes, "Wire protocols").

TEST(FriCommand, WithJointPositionHasTheObservedBytes) {
  const auto bytes = Encoded(CommandMessage{.sequence = 8, .reflected_sequence = 8, .q = Joints(0.5)});
  const std::vector<std::uint8_t> prefix{0x0a, 0x08, 0x08, 0x81, 0x80, 0x0d, 0x10, 0x08,
                                         0x18, 0x08, 0x12, 0x41, 0x0a, 0x3f, 0x09};
  ASSERT_EQ(bytes.size(), 77u);
  EXPECT_TRUE(std::equal(prefix.begin(), prefix.end(), bytes.begin()));
  for (std::size_t joint = 0; joint < 7; ++joint) EXPECT_EQ(bytes[14 + 9 * joint], 0x09) << "tag, unpacked";
}

TEST(FriCommand, WithWrenchOrTorqueHasTheObservedSize) {
  CommandMessage wrench{.sequence = 8, .reflected_sequence = 8, .q = Joints(0.5)};
  wrench.wire_wrench = {1, 2, 3, 4, 5, 6};
  const auto bytes = Encoded(wrench);
  EXPECT_EQ(bytes.size(), 129u);
  const std::vector<std::uint8_t> start{0x12, 0x32, 0x0a, 0x30};
  EXPECT_NE(std::search(bytes.begin(), bytes.end(), start.begin(), start.end()), bytes.end());

  CommandMessage torque{.sequence = 8, .reflected_sequence = 8, .q = Joints(0.5)};
  torque.tau = Joints(1.0);
  EXPECT_EQ(Encoded(torque).size(), 143u);
}

TEST(FriMonitoring, HasTheObservedSizes) {
  EXPECT_EQ(Bytes(Monitoring(8, fri::MONITORING_READY)).size(), 401u);
  EXPECT_EQ(Bytes(Monitoring(8, fri::COMMANDING_WAIT)).size(), 466u);
}

// nanopb against libprotobuf.

TEST(FriMonitoring, DecodesWhatLibprotobufEncodes) {
  fri::FRIMonitoringMessage sent = Monitoring(300, fri::COMMANDING_ACTIVE);
  sent.mutable_connectioninfo()->set_quality(fri::GOOD);
  sent.mutable_connectioninfo()->set_sendperiod(5);
  sent.mutable_connectioninfo()->set_receivemultiplier(2);
  sent.mutable_robotinfo()->set_safetystate(fri::STOP_LEVEL_1);
  sent.mutable_robotinfo()->set_drivestate(6, fri::TRANSITIONING);
  sent.mutable_ipodata()->set_trackingperformance(0.75);
  MonitoringMessage m;
  ASSERT_EQ(DecodeMonitoring(Bytes(sent), m), CodecError::kNone);
  EXPECT_EQ(m.sequence, 300u);
  EXPECT_EQ(m.reflected_sequence, 299u);
  EXPECT_EQ(m.session, SessionState::kCommandingActive);
  EXPECT_EQ(m.quality, FriQuality::kGood);
  EXPECT_EQ(m.send_period_ms, 5u);
  EXPECT_EQ(m.receive_multiplier, 2u);
  EXPECT_EQ(m.safety, FriSafetyState::kStopLevel1);
  EXPECT_EQ(m.operation, FriOperationMode::kAutomatic);
  EXPECT_EQ(m.control, FriControlMode::kPosition);
  EXPECT_EQ(m.drives[0], FriDriveState::kActive);
  EXPECT_EQ(m.drives[6], FriDriveState::kTransitioning);
  EXPECT_EQ(m.q_meas, Joints(0.1));
  EXPECT_EQ(m.tau_meas, Joints(10.0));
  EXPECT_EQ(m.q_cmd, Joints(0.2));
  EXPECT_EQ(m.tau_cmd, Joints(20.0));
  EXPECT_EQ(m.tau_ext, Joints(-3.0));
  EXPECT_EQ(m.q_ipo, Joints(0.3));
  EXPECT_EQ(m.command_mode, FriCommandMode::kPosition);
  EXPECT_EQ(m.overlay, FriOverlay::kJoint);
  EXPECT_EQ(m.tracking_performance, 0.75);
  EXPECT_EQ(m.time->sec, 1'700'000'000u);
  EXPECT_EQ(m.time->nanosec, 123'456'789u);
}

TEST(FriCommand, IsReadAndWrittenAlikeByLibprotobuf) {
  CommandMessage sent{.sequence = 70'000, .reflected_sequence = 5, .q = Joints(-0.4)};
  sent.wire_wrench = {1, 2, 3, 4, 5, 6};
  sent.tau = Joints(7.0);
  const auto bytes = Encoded(sent);
  fri::FRICommandMessage oracle;
  ASSERT_TRUE(oracle.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())));
  EXPECT_EQ(oracle.header().messageidentifier(), 0x34001u);
  EXPECT_EQ(oracle.header().sequencecounter(), 70'000u);
  EXPECT_EQ(oracle.header().reflectedsequencecounter(), 5u);
  EXPECT_EQ(oracle.commanddata().jointposition().value(6), Joints(-0.4)[6]);
  EXPECT_EQ(oracle.commanddata().cartesianwrenchfeedforward().element(5), 6.0);
  EXPECT_EQ(oracle.commanddata().jointtorque().value(0), 7.0);
  EXPECT_EQ(Bytes(oracle), bytes);
}

// A protobuf reader must take repeated scalars packed as well.
TEST(FriMonitoring, AcceptsPackedJointValues) {
  std::string packed(1, '\x0a');
  packed += '\x38';  // 56 bytes
  for (const double joint : Joints(0.1)) {
    std::array<char, sizeof joint> raw{};
    std::memcpy(raw.data(), &joint, sizeof joint);
    packed.append(raw.data(), raw.size());
  }
  fri::FRIMonitoringMessage sent = Monitoring(1, fri::MONITORING_READY);
  std::string bytes;
  sent.mutable_monitordata()->clear_measuredjointposition();
  sent.SerializeToString(&bytes);
  // monitorData (3) again, merged: measuredJointPosition (1) with the packed values
  bytes += std::string("\x1a\x3c\x0a\x3a", 4) + packed;
  MonitoringMessage m;
  ASSERT_EQ(DecodeMonitoring(std::vector<std::uint8_t>(bytes.begin(), bytes.end()), m), CodecError::kNone);
  EXPECT_EQ(m.q_meas, Joints(0.1));
}

TEST(FriMonitoring, SkipsFieldsOfLaterVersions) {
  auto bytes = Bytes(Monitoring(1, fri::MONITORING_READY));
  bytes.insert(bytes.end(), {0x7a, 0x02, 0x08, 0x05});  // endOfMessageData: known, unused
  bytes.insert(bytes.end(), {0x8a, 0x01, 0x01, 0xff});  // field 17: unknown
  EXPECT_EQ(ErrorOf(bytes), CodecError::kNone);
}

// Hostile input: each change to a valid message has its reason.
TEST(FriMonitoring, RefusesWithTheReason) {
  using Change = std::function<void(fri::FRIMonitoringMessage&)>;
  const auto with = [](const Change& change) {
    fri::FRIMonitoringMessage m = Monitoring(1, fri::COMMANDING_ACTIVE);
    change(m);
    return ErrorOf(Bytes(m));
  };
  EXPECT_EQ(with([](auto&) {}), CodecError::kNone);
  EXPECT_EQ(with([](auto& m) { m.mutable_header()->set_messageidentifier(0x34001); }), CodecError::kWrongId);
  EXPECT_EQ(with([](auto& m) { m.clear_header(); }), CodecError::kMalformed);
  EXPECT_EQ(with([](auto& m) { m.clear_connectioninfo(); }), CodecError::kMissingField);
  EXPECT_EQ(with([](auto& m) { m.clear_ipodata(); }), CodecError::kMissingField);
  EXPECT_EQ(with([](auto& m) { m.clear_monitordata(); }), CodecError::kMissingField);
  EXPECT_EQ(
      with([](auto& m) { m.mutable_monitordata()->mutable_measuredtorque()->mutable_value()->RemoveLast(); }),
      CodecError::kWrongCount);
  EXPECT_EQ(with([](auto& m) { m.mutable_monitordata()->mutable_measuredtorque()->clear_value(); }),
            CodecError::kWrongCount);
  EXPECT_EQ(with([](auto& m) { m.mutable_monitordata()->mutable_externaltorque()->add_value(1.0); }),
            CodecError::kMalformed);
  EXPECT_EQ(with([](auto& m) { m.mutable_robotinfo()->set_numberofjoints(6); }), CodecError::kWrongCount);
  EXPECT_EQ(with([](auto& m) { m.mutable_robotinfo()->mutable_drivestate()->RemoveLast(); }),
            CodecError::kWrongCount);
  for (const double bad : {kNaN, kInf, -kInf}) {
    EXPECT_EQ(with([&](auto& m) { m.mutable_ipodata()->mutable_jointposition()->set_value(3, bad); }),
              CodecError::kNotFinite);
    EXPECT_EQ(with([&](auto& m) { m.mutable_monitordata()->mutable_commandedtorque()->set_value(0, bad); }),
              CodecError::kNotFinite);
    EXPECT_EQ(with([&](auto& m) { m.mutable_ipodata()->set_trackingperformance(bad); }),
              CodecError::kNotFinite);
  }
  for (const std::uint32_t bad : {0u, 101u, 0xffffffffu}) {
    EXPECT_EQ(with([&](auto& m) { m.mutable_connectioninfo()->set_sendperiod(bad); }),
              CodecError::kOutOfRange);
    EXPECT_EQ(with([&](auto& m) { m.mutable_connectioninfo()->set_receivemultiplier(bad); }),
              CodecError::kOutOfRange);
  }
}

// libprotobuf cannot write an enum that does not exist, so the byte is changed after it.
TEST(FriMonitoring, RefusesAnEnumThatDoesNotExist) {
  fri::ConnectionInfo connection = Monitoring(1, fri::MONITORING_READY).connectioninfo();
  const auto good = Bytes(connection);
  auto bytes = Bytes(Monitoring(1, fri::MONITORING_READY));
  const auto at = std::search(bytes.begin(), bytes.end(), good.begin(), good.end());
  ASSERT_NE(at, bytes.end());
  *(at + 1) = 5;  // sessionState
  EXPECT_EQ(ErrorOf(bytes), CodecError::kOutOfRange);
  *(at + 1) = 2;
  *(at + 3) = 4;  // quality
  EXPECT_EQ(ErrorOf(bytes), CodecError::kOutOfRange);
  *(at + 3) = 3;
  EXPECT_EQ(ErrorOf(bytes), CodecError::kNone);
}

TEST(FriMonitoring, RefusesEmptyTruncatedAndOversized) {
  EXPECT_EQ(ErrorOf({}), CodecError::kMalformed);
  auto bytes = Bytes(Monitoring(1, fri::COMMANDING_ACTIVE));
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_NE(ErrorOf({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)}), CodecError::kNone);
  // unknown fields are legal protobuf, but not beyond the datagram's size
  while (bytes.size() <= kFriMaxDatagram) bytes.insert(bytes.end(), {0x88, 0x01, 0x01});
  EXPECT_EQ(ErrorOf(bytes), CodecError::kTooLong);
}

TEST(FriMonitoring, LeavesTheMessageAloneOnError) {
  MonitoringMessage m;
  m.sequence = 42;
  fri::FRIMonitoringMessage bad = Monitoring(7, fri::COMMANDING_ACTIVE);
  bad.mutable_ipodata()->mutable_jointposition()->set_value(0, kNaN);
  ASSERT_NE(DecodeMonitoring(Bytes(bad), m), CodecError::kNone);
  EXPECT_EQ(m.sequence, 42u);
}

TEST(FriCommand, NeverEncodesWhatIsNotFinite) {
  std::array<std::uint8_t, kFriMaxDatagram> buffer{};
  std::size_t size = 0;
  for (const double bad : {kNaN, kInf}) {
    CommandMessage message{.q = Joints(0.0)};
    (*message.q)[4] = bad;
    EXPECT_EQ(EncodeCommand(message, buffer, size), CodecError::kNotFinite);
    message.q = Joints(0.0);
    message.wire_wrench = {0, 0, 0, 0, 0, bad};
    EXPECT_EQ(EncodeCommand(message, buffer, size), CodecError::kNotFinite);
  }
}

TEST(FriCommand, ReportsABufferTooSmall) {
  std::array<std::uint8_t, 76> buffer{};
  std::size_t size = 0;
  EXPECT_EQ(
      EncodeCommand(CommandMessage{.sequence = 8, .reflected_sequence = 8, .q = Joints(0.5)}, buffer, size),
      CodecError::kNoSpace);
}

TEST(FriCodec, DoesNotAllocate) {
  const auto bytes = Bytes(Monitoring(8, fri::COMMANDING_ACTIVE));
  const CommandMessage command{.q = Joints(0.5)};
  std::array<std::uint8_t, kFriMaxDatagram> buffer{};
  std::size_t size = 0;
  MonitoringMessage m;
  rt::NoAllocScope scope;
  const CodecError decoded = DecodeMonitoring(bytes, m);
  const CodecError encoded = EncodeCommand(command, buffer, size);
  EXPECT_EQ(scope.heap_calls(), 0);
  EXPECT_EQ(scope.locks(), 0);
  EXPECT_EQ(decoded, CodecError::kNone);
  EXPECT_EQ(encoded, CodecError::kNone);
}

}  // namespace
}  // namespace osteon::io
