#include "io/fri/codec.h"

#include <algorithm>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"
#include "tests/io/fri/fri_golden.h"
#include "tests/io/fri/fri_oracle.h"

// Tests the codec of FRI's messages against fixed bytes (fri_golden.h) and against libprotobuf
// (fri_oracle.h).

namespace osteon::io {
namespace {

using control::SessionState;
using test::Bytes;
using test::Datagram;
using test::Joints;
using test::Monitoring;
namespace golden = test::golden;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

constexpr std::array kFamilies{FriFamily::k1, FriFamily::k2_5, FriFamily::k2_7};

std::vector<std::uint8_t> Encoded(const CommandMessage& message, FriFamily family = FriFamily::k1) {
  std::vector<std::uint8_t> buffer(kFriMaxDatagram);
  std::size_t size = 0;
  EXPECT_EQ(EncodeCommand(family, message, buffer, size), CodecError::kNone);
  buffer.resize(size);
  return buffer;
}

// The decoder's error for an arm's datagram.
CodecError ErrorOf(const std::vector<std::uint8_t>& datagram, FriFamily family = FriFamily::k1) {
  MonitoringMessage message;
  return DecodeMonitoring(family, datagram, message);
}

// --- against fixed bytes, for every version

TEST(FriVersion, EachVersionBelongsToAFamily) {
  EXPECT_EQ(FamilyOf(FriVersion::k1_11), FriFamily::k1);
  EXPECT_EQ(FamilyOf(FriVersion::k1_16), FriFamily::k1);
  EXPECT_EQ(FamilyOf(FriVersion::k2_5), FriFamily::k2_5);
  EXPECT_EQ(FamilyOf(FriVersion::k2_7), FriFamily::k2_7);
}

TEST(FriGolden, EncodesCommandsOfEveryVersion) {
  const CommandMessage header{.sequence = 8, .reflected_sequence = 8};
  CommandMessage position = header;
  position.q = Joints(0.5);
  CommandMessage wrench = position, torque = position;
  wrench.wire_wrench = {1, 2, 3, 4, 5, 6};
  torque.tau = Joints(1.0);
  for (const FriVersion version : kFriVersions) {
    SCOPED_TRACE(Name(version));
    const FriFamily family = FamilyOf(version);
    const bool framed = version == FriVersion::k2_7;
    EXPECT_EQ(Encoded(header, family),
              golden::FromHex(framed ? golden::kHeaderOnlyFramed : golden::kHeaderOnly));
    EXPECT_EQ(Encoded(wrench, family),
              golden::FromHex(framed ? golden::kPositionWrenchFramed : golden::kPositionWrench));
    EXPECT_EQ(test::Inside(family, Encoded(position, family)).size(), 77u);
    if (framed) continue;
    EXPECT_EQ(Encoded(position, family), golden::FromHex(golden::kPosition));
    EXPECT_EQ(Encoded(torque, family), golden::FromHex(golden::kPositionTorque));
  }
  // first bytes and sizes as observed on real arms
  const auto bytes = Encoded(position);
  const std::vector<std::uint8_t> prefix{0x0a, 0x08, 0x08, 0x81, 0x80, 0x0d, 0x10, 0x08,
                                         0x18, 0x08, 0x12, 0x41, 0x0a, 0x3f, 0x09};
  EXPECT_TRUE(std::equal(prefix.begin(), prefix.end(), bytes.begin()));
  EXPECT_EQ(Encoded(position).size(), 77u);
  EXPECT_EQ(Encoded(wrench).size(), 129u);
  EXPECT_EQ(Encoded(torque).size(), 143u);
  EXPECT_EQ(Encoded(header, FriFamily::k2_5).size(), 10u);
  EXPECT_EQ(Encoded(header, FriFamily::k2_7).size(), 18u);
  EXPECT_EQ(Encoded(wrench, FriFamily::k2_7).size(), 137u);
}

TEST(FriGolden, DecodesMonitoringMessagesOfEveryVersion) {
  EXPECT_EQ(golden::FromHex(golden::kMonitoring1).size(), 401u);
  EXPECT_EQ(golden::FromHex(golden::kCommanding1).size(), 466u);
  EXPECT_EQ(Bytes(Monitoring(8, fri::MONITORING_READY)), golden::FromHex(golden::kMonitoring1));
  for (const FriFamily family : kFamilies) {
    SCOPED_TRACE(Describe(family));
    const auto bytes = golden::FromHex(family == FriFamily::k1     ? golden::kCommanding1
                                       : family == FriFamily::k2_5 ? golden::kCommanding2_5
                                                                   : golden::kCommanding2_7);
    EXPECT_EQ(Datagram(family, Monitoring(8, fri::COMMANDING_ACTIVE, family)), bytes) << "libprotobuf";
    MonitoringMessage m;
    ASSERT_EQ(DecodeMonitoring(family, bytes, m), CodecError::kNone);
    EXPECT_EQ(m.sequence, 8u);
    EXPECT_EQ(m.q_meas, Joints(0.1));
    EXPECT_EQ(m.q_ipo, Joints(0.3));
    EXPECT_EQ(m.tau_ext, Joints(-3.0));
    EXPECT_EQ(m.q_cmd.has_value(), family == FriFamily::k1);
    EXPECT_EQ(m.X_meas.has_value(), family != FriFamily::k1);
    EXPECT_EQ(m.X_ipo.has_value(), family != FriFamily::k1);
    EXPECT_EQ(m.wire_force.has_value(), family == FriFamily::k2_7);
  }
}

// A message shows to which family of versions its arm belongs. A client of another family must refuse the
// message for this reason.
TEST(FriVersion, IsDetectedFromAMessage) {
  for (const FriFamily arm : kFamilies) {
    const auto bytes = Datagram(arm, Monitoring(8, fri::MONITORING_READY, arm));
    EXPECT_EQ(DetectFamily(bytes), arm) << Describe(arm);
    for (const FriFamily client : kFamilies)
      EXPECT_EQ(ErrorOf(bytes, client), client == arm ? CodecError::kNone : CodecError::kOtherVersion)
          << Describe(arm) << " read as " << Describe(client);
  }
  EXPECT_FALSE(DetectFamily({}));
  EXPECT_FALSE(DetectFamily(Encoded(CommandMessage{}))) << "not a monitoring message";
  fri::FRIMonitoringMessage idle;  // an idle arm need not report anything but its state
  *idle.mutable_header() = Monitoring(1, fri::IDLE).header();
  *idle.mutable_connectioninfo() = Monitoring(1, fri::IDLE).connectioninfo();
  EXPECT_FALSE(DetectFamily(Bytes(idle)));
  EXPECT_EQ(ErrorOf(Bytes(idle), FriFamily::k1), CodecError::kNone);
  EXPECT_EQ(ErrorOf(Bytes(idle), FriFamily::k2_5), CodecError::kNone);
  EXPECT_EQ(ErrorOf(Datagram(FriFamily::k2_7, idle), FriFamily::k2_7), CodecError::kNone);
  EXPECT_EQ(ErrorOf(Datagram(FriFamily::k2_7, idle), FriFamily::k1), CodecError::kOtherVersion);
}

TEST(FriFrame, RefusesAWrongLengthOrChecksum) {
  const auto good = Datagram(FriFamily::k2_7, Monitoring(8, fri::MONITORING_READY, FriFamily::k2_7));
  ASSERT_EQ(ErrorOf(good, FriFamily::k2_7), CodecError::kNone);
  for (std::size_t i = 0; i < good.size(); ++i) {
    auto bad = good;
    bad[i] ^= 0x10;
    EXPECT_EQ(ErrorOf(bad, FriFamily::k2_7), i < 4 ? CodecError::kMalformed : CodecError::kChecksum) << i;
  }
  EXPECT_EQ(ErrorOf({good.begin(), good.end() - 1}, FriFamily::k2_7), CodecError::kMalformed);
  EXPECT_EQ(ErrorOf({0, 0, 0, 0, 0, 0, 0, 0}, FriFamily::k2_7), CodecError::kMalformed)
      << "no message inside";
}

// --- against libprotobuf

TEST(FriMonitoring, DecodesMessagesOfLibprotobuf) {
  fri::FRIMonitoringMessage sent = Monitoring(300, fri::COMMANDING_ACTIVE);
  sent.mutable_connectioninfo()->set_quality(fri::GOOD);
  sent.mutable_connectioninfo()->set_sendperiod(5);
  sent.mutable_connectioninfo()->set_receivemultiplier(2);
  sent.mutable_robotinfo()->set_safetystate(fri::STOP_LEVEL_1);
  sent.mutable_robotinfo()->set_drivestate(6, fri::TRANSITIONING);
  sent.mutable_ipodata()->set_trackingperformance(0.75);
  MonitoringMessage m;
  ASSERT_EQ(DecodeMonitoring(FriFamily::k1, Bytes(sent), m), CodecError::kNone);
  EXPECT_EQ(m.sequence, 300u);
  EXPECT_EQ(m.reflected_sequence, 299u);
  EXPECT_EQ(m.session, SessionState::kCommandingActive);
  EXPECT_EQ(m.quality, FriQuality::kGood);
  EXPECT_EQ(m.send_period_ms, 5u);
  EXPECT_EQ(m.receive_multiplier, 2u);
  EXPECT_EQ(m.safety, FriSafetyState::kStopLevel1);
  EXPECT_EQ(m.operation, FriOperationMode::kAutomatic);
  EXPECT_EQ(m.control, control::ControlMode::kPosition);
  EXPECT_EQ(m.drives[0], FriDriveState::kActive);
  EXPECT_EQ(m.drives[6], FriDriveState::kTransitioning);
  EXPECT_EQ(m.q_meas, Joints(0.1));
  EXPECT_EQ(m.tau_meas, Joints(10.0));
  EXPECT_EQ(m.q_cmd, Joints(0.2));
  EXPECT_EQ(m.tau_cmd, Joints(20.0));
  EXPECT_EQ(m.tau_ext, Joints(-3.0));
  EXPECT_EQ(m.q_ipo, Joints(0.3));
  EXPECT_EQ(m.command_mode, control::CommandMode::kPosition);
  EXPECT_EQ(m.overlay, FriOverlay::kJoint);
  EXPECT_EQ(m.tracking_performance, 0.75);
  EXPECT_EQ(m.time->sec, 1'700'000'000u);
  EXPECT_EQ(m.time->nanosec, 123'456'789u);
}

TEST(FriCommand, LibprotobufReadsAndWritesTheSameCommand) {
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

TEST(FriMonitoring, DecodesPosesForceAndOutputsOfTheVersionsThatHaveThem) {
  for (const FriFamily family : kFamilies) {
    SCOPED_TRACE(Describe(family));
    fri::FRIMonitoringMessage sent = Monitoring(8, fri::COMMANDING_ACTIVE, family);
    auto* digital = sent.mutable_monitordata()->add_readiorequest();
    digital->set_name("Drill.Ready");
    digital->set_type(fri::DIGITAL);
    digital->set_direction(fri::INPUT);
    digital->set_digitalvalue(0x123456789aull);
    auto* analog = sent.mutable_monitordata()->add_readiorequest();
    analog->set_name("Pump.Flow");
    analog->set_type(fri::ANALOG);
    analog->set_direction(fri::OUTPUT);
    analog->set_analogvalue(-2.5);
    auto* frame = sent.add_requestedtransformations();
    if (family == FriFamily::k1) {
      frame->set_name("flange");
      for (const double element : {0., -1., 0., 100., 0., 0., -1., -200., 1., 0., 0., 350.5})
        frame->add_element(element);
    } else {
      test::PutPose(frame);
    }
    frame->mutable_timestamp()->set_sec(5);
    frame->mutable_timestamp()->set_nanosec(6);
    sent.add_requestedtransformations()->set_name("unset");

    MonitoringMessage m;
    ASSERT_EQ(DecodeMonitoring(family, Datagram(family, sent), m), CodecError::kNone);
    ASSERT_EQ(m.ios.size(), 2u);
    EXPECT_EQ(m.ios[0].name.view(), "Drill.Ready");
    EXPECT_EQ(m.ios[0].type, FriIoType::kDigital);
    EXPECT_EQ(m.ios[0].direction, FriIoDirection::kInput);
    EXPECT_EQ(m.ios[0].digital, 0x123456789aull);
    EXPECT_FALSE(m.ios[0].analog);
    EXPECT_EQ(m.ios[1].direction, FriIoDirection::kOutput);
    EXPECT_EQ(m.ios[1].analog, -2.5);
    // a rotation by a third of a full turn, which maps x to z, y to -x, and z to -y
    ASSERT_EQ(m.transformations.size(), 2u);
    EXPECT_EQ(m.transformations[0].name.view(), "flange");
    EXPECT_EQ(m.transformations[0].time, (FriTime{5, 6}));
    Pose X = Pose::Identity();
    X.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    X.translation() << 0.1, -0.2, 0.3505;
    EXPECT_TRUE(Pose(m.transformations[0].X).isApprox(X, 1e-15));
    EXPECT_TRUE(Pose(m.transformations[1].X).isApprox(Pose::Identity()));
    if (family == FriFamily::k1) continue;
    EXPECT_EQ(m.X_meas->name.view(), "flange");
    EXPECT_EQ(m.X_meas->element, (std::array<double, 7>{100, -200, 350.5, .5, .5, -.5, .5}));
    EXPECT_EQ(m.X_meas->redundancy->value, 0.25);
    EXPECT_EQ(m.X_ipo->element, m.X_meas->element);
    if (family == FriFamily::k2_7) {
      EXPECT_EQ(m.wire_force, (std::array<double, 6>{1, 2, 3, 4, 5, 6}));
    }
  }
}

TEST(FriCommand, LibprotobufReadsTheSamePoses) {
  for (const FriFamily family : kFamilies) {
    SCOPED_TRACE(Describe(family));
    CommandMessage sent{.sequence = 1, .reflected_sequence = 2, .q = Joints(-0.4)};
    sent.X = FriPose{.name = FriName("flange"), .element = {1, 2, 3, 1, 0, 0, 0}};
    sent.X->redundancy = FriRedundancy{.strategy = 4, .value = 0.5};
    const auto bytes = Encoded(sent, family);
    fri::FRICommandMessage oracle;
    const auto inside = test::Inside(family, bytes);
    ASSERT_TRUE(oracle.ParseFromArray(inside.data(), static_cast<int>(inside.size())));
    EXPECT_EQ(Datagram(family, oracle), bytes) << "byte for byte";
    const auto& data = oracle.commanddata();
    EXPECT_EQ(data.has_cartesianpose(), family != FriFamily::k1);
    EXPECT_EQ(data.has_redundancyinformation(), family != FriFamily::k1);
  }
}

TEST(FriMonitoring, RefusesPosesOfWrongSizeOrWithoutARotation) {
  const auto with = [](const std::vector<double>& elements, FriFamily family,
                       const std::string& name = "cup") {
    fri::FRIMonitoringMessage m = Monitoring(1, fri::MONITORING_READY, family);
    auto* frame = m.add_requestedtransformations();
    frame->set_name(name);
    for (const double element : elements) frame->add_element(element);
    return ErrorOf(Datagram(family, m), family);
  };
  const std::vector<double> quaternion{0, 0, 0, 1, 0, 0, 0}, matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  EXPECT_EQ(with(matrix, FriFamily::k1), CodecError::kNone);
  EXPECT_EQ(with(quaternion, FriFamily::k2_5), CodecError::kNone);
  EXPECT_EQ(with(matrix, FriFamily::k2_5), CodecError::kWrongCount);
  EXPECT_EQ(with(quaternion, FriFamily::k1), CodecError::kWrongCount);
  EXPECT_EQ(with({0, 0, 0, 0, 0, 0, 0}, FriFamily::k2_7), CodecError::kOutOfRange) << "no rotation";
  EXPECT_EQ(with({kInf, 0, 0, 1, 0, 0, 0}, FriFamily::k2_7), CodecError::kNotFinite);
  EXPECT_EQ(with({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0}, FriFamily::k1), CodecError::kOutOfRange)
      << "a mirror";
  EXPECT_EQ(with(matrix, FriFamily::k1, std::string(63, 'n')), CodecError::kNone);
  EXPECT_EQ(with(matrix, FriFamily::k1, std::string(64, 'n')), CodecError::kMalformed);
}

// By the rules of protobuf, a reader must also accept repeated numbers that are packed.
TEST(FriMonitoring, AcceptsPackedJointValues) {
  std::string packed(1, '\x0a');
  packed += '\x38';  // length of the packed values: 56 bytes
  for (const double joint : Joints(0.1)) {
    std::array<char, sizeof joint> raw{};
    std::memcpy(raw.data(), &joint, sizeof joint);
    packed.append(raw.data(), raw.size());
  }
  fri::FRIMonitoringMessage sent = Monitoring(1, fri::MONITORING_READY);
  std::string bytes;
  sent.mutable_monitordata()->clear_measuredjointposition();
  sent.SerializeToString(&bytes);
  // field monitorData (3) once more, which a reader must merge with the first: it has measuredJointPosition
  // (1) with the packed values
  bytes += std::string("\x1a\x3c\x0a\x3a", 4) + packed;
  MonitoringMessage m;
  ASSERT_EQ(DecodeMonitoring(FriFamily::k1, std::vector<std::uint8_t>(bytes.begin(), bytes.end()), m),
            CodecError::kNone);
  EXPECT_EQ(m.q_meas, Joints(0.1));
}

TEST(FriMonitoring, SkipsFieldsOfLaterVersions) {
  auto bytes = Bytes(Monitoring(1, fri::MONITORING_READY));
  bytes.insert(bytes.end(),
               {0x7a, 0x02, 0x08, 0x05});  // the field endOfMessageData, which is known but not used
  bytes.insert(bytes.end(), {0x8a, 0x01, 0x01, 0xff});  // field 17, which is unknown
  EXPECT_EQ(ErrorOf(bytes), CodecError::kNone);
}

// Each of these changes to a valid message must be refused, with the matching reason.
TEST(FriMonitoring, RefusesEachDefectWithItsReason) {
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

// libprotobuf can't write an enum value that does not exist, so the test changes the encoded bytes.
TEST(FriMonitoring, RefusesAnEnumThatDoesNotExist) {
  fri::ConnectionInfo connection = Monitoring(1, fri::MONITORING_READY).connectioninfo();
  const auto good = Bytes(connection);
  auto bytes = Bytes(Monitoring(1, fri::MONITORING_READY));
  const auto at = std::search(bytes.begin(), bytes.end(), good.begin(), good.end());
  ASSERT_NE(at, bytes.end());
  *(at + 1) = 5;  // value of sessionState
  EXPECT_EQ(ErrorOf(bytes), CodecError::kOutOfRange);
  *(at + 1) = 2;
  *(at + 3) = 4;  // value of the connection's quality
  EXPECT_EQ(ErrorOf(bytes), CodecError::kOutOfRange);
  *(at + 3) = 3;
  EXPECT_EQ(ErrorOf(bytes), CodecError::kNone);
}

TEST(FriMonitoring, RefusesEmptyTruncatedAndOversizedMessages) {
  EXPECT_EQ(ErrorOf({}), CodecError::kMalformed);
  auto bytes = Bytes(Monitoring(1, fri::COMMANDING_ACTIVE));
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_NE(ErrorOf({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)}), CodecError::kNone);
  // unknown fields are legal in protobuf, but the datagram must not exceed its largest size
  while (bytes.size() <= kFriMaxDatagram) bytes.insert(bytes.end(), {0x88, 0x01, 0x01});
  EXPECT_EQ(ErrorOf(bytes), CodecError::kTooLong);
}

TEST(FriMonitoring, LeavesTheOutputUnchangedOnError) {
  MonitoringMessage m;
  m.sequence = 42;
  fri::FRIMonitoringMessage bad = Monitoring(7, fri::COMMANDING_ACTIVE);
  bad.mutable_ipodata()->mutable_jointposition()->set_value(0, kNaN);
  ASSERT_NE(DecodeMonitoring(FriFamily::k1, Bytes(bad), m), CodecError::kNone);
  EXPECT_EQ(m.sequence, 42u);
}

TEST(FriCommand, NeverEncodesValuesThatAreNotFinite) {
  std::array<std::uint8_t, kFriMaxDatagram> buffer{};
  std::size_t size = 0;
  for (const double bad : {kNaN, kInf}) {
    CommandMessage message{.q = Joints(0.0)};
    (*message.q)[4] = bad;
    EXPECT_EQ(EncodeCommand(FriFamily::k1, message, buffer, size), CodecError::kNotFinite);
    message.q = Joints(0.0);
    message.wire_wrench = {0, 0, 0, 0, 0, bad};
    EXPECT_EQ(EncodeCommand(FriFamily::k1, message, buffer, size), CodecError::kNotFinite);
  }
}

TEST(FriCommand, ReportsABufferTooSmall) {
  std::array<std::uint8_t, 76> buffer{};
  std::size_t size = 0;
  EXPECT_EQ(
      EncodeCommand(FriFamily::k1, CommandMessage{.sequence = 8, .reflected_sequence = 8, .q = Joints(0.5)},
                    buffer, size),
      CodecError::kNoSpace);
}

TEST(FriCodec, DoesNotAllocate) {
  for (const FriFamily family : kFamilies) {
    const auto bytes = Datagram(family, Monitoring(8, fri::COMMANDING_ACTIVE, family));
    CommandMessage command{.q = Joints(0.5), .wire_wrench = std::array<double, 6>{}, .tau = Joints(1.0)};
    std::array<std::uint8_t, kFriMaxDatagram> buffer{};
    std::size_t size = 0;
    MonitoringMessage m;
    rt::CheckedNoAllocScope no_alloc;
    const CodecError decoded = DecodeMonitoring(family, bytes, m);
    const auto other = DetectFamily(bytes);
    const CodecError encoded = EncodeCommand(family, command, buffer, size);
    no_alloc.End();
    EXPECT_EQ(decoded, CodecError::kNone);
    EXPECT_EQ(encoded, CodecError::kNone);
    EXPECT_EQ(other, family);
  }
}

}  // namespace
}  // namespace osteon::io
