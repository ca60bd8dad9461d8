#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fri.pb.h>
#include <zlib.h>

#include "control/ports.h"
#include "io/fri/version.h"

// Messages of the arm, written by libprotobuf from fri.proto, and commands as libprotobuf reads them:
// independent of the code under test.

namespace osteon::io::test {

/// Adds seven values, from `first` in steps of 0.125.
inline void PutJoints(double first, fri::JointValues* to) {
  for (int i = 0; i < control::kJoints; ++i) to->add_value(first + 0.125 * i);
}

/// The values that PutJoints adds.
inline control::JointArray Joints(double first) {
  control::JointArray q{};
  for (int i = 0; i < control::kJoints; ++i) q[static_cast<std::size_t>(i)] = first + 0.125 * i;
  return q;
}

/// A pose as FRI 2.x sends it: lengths in mm, then the quaternion of a third of a turn about (1, -1, 1) /
/// sqrt(3).
inline void PutPose(fri::Transformation* to) {
  to->set_name("flange");
  for (const double element : {100.0, -200.0, 350.5, 0.5, 0.5, -0.5, 0.5}) to->add_element(element);
}

/// A monitoring message of an arm. FRI 1.x has five joint vectors. FRI 2.x has four joint vectors and the
/// pose, and 2.7 also the external force. While the arm is commanded, the message also has the interpolator's
/// position (in 2.x also its pose).
inline fri::FRIMonitoringMessage Monitoring(std::uint32_t sequence, fri::SessionState state,
                                            FriFamily family = FriFamily::k1) {
  fri::FRIMonitoringMessage m;
  m.mutable_header()->set_messageidentifier(0x245142);
  m.mutable_header()->set_sequencecounter(sequence);
  m.mutable_header()->set_reflectedsequencecounter(sequence == 0 ? 0 : sequence - 1);
  auto* robot = m.mutable_robotinfo();
  robot->set_numberofjoints(7);
  robot->set_safetystate(fri::NORMAL_OPERATION);
  for (int i = 0; i < control::kJoints; ++i) robot->add_drivestate(fri::ACTIVE);
  robot->set_operationmode(fri::AUTOMATIC_MODE);
  robot->set_controlmode(fri::POSITION_CONTROL);
  auto* monitor = m.mutable_monitordata();
  PutJoints(0.1, monitor->mutable_measuredjointposition());
  PutJoints(10.0, monitor->mutable_measuredtorque());
  if (family == FriFamily::k1) {
    PutJoints(0.2, monitor->mutable_commandedjointposition());
  } else {
    PutPose(monitor->mutable_measuredcartesianpose());
    monitor->mutable_measuredredundancyinformation()->set_strategy(0);
    monitor->mutable_measuredredundancyinformation()->set_value(0.25);
  }
  if (family == FriFamily::k2_7)
    for (int i = 1; i <= 6; ++i) monitor->mutable_externalforce()->add_element(i);
  PutJoints(20.0, monitor->mutable_commandedtorque());
  PutJoints(-3.0, monitor->mutable_externaltorque());
  monitor->mutable_timestamp()->set_sec(1'700'000'000);
  monitor->mutable_timestamp()->set_nanosec(123'456'789);  // four bytes as a varint
  auto* connection = m.mutable_connectioninfo();
  connection->set_sessionstate(state);
  connection->set_quality(fri::EXCELLENT);
  connection->set_sendperiod(1);
  connection->set_receivemultiplier(1);
  auto* ipo = m.mutable_ipodata();
  if (state >= fri::COMMANDING_WAIT) {
    PutJoints(0.3, ipo->mutable_jointposition());
    if (family != FriFamily::k1) {
      PutPose(ipo->mutable_cartesianpose());
      *ipo->mutable_redundancyinformation() = monitor->measuredredundancyinformation();
    }
  }
  ipo->set_clientcommandmode(fri::POSITION);
  ipo->set_overlaytype(fri::JOINT);
  ipo->set_trackingperformance(0.0);
  return m;
}

/// The encoded message, without FRI 2.7's frame.
inline std::vector<std::uint8_t> Bytes(const google::protobuf::MessageLite& message) {
  const std::string text = message.SerializePartialAsString();
  return {text.begin(), text.end()};
}

/// The bytes in FRI 2.7's frame: first their number, then the bytes, then their CRC-32.
inline std::vector<std::uint8_t> Framed(std::vector<std::uint8_t> bytes) {
  const auto put = [](std::uint32_t v) {
    return std::array{static_cast<std::uint8_t>(v), static_cast<std::uint8_t>(v >> 8),
                      static_cast<std::uint8_t>(v >> 16), static_cast<std::uint8_t>(v >> 24)};
  };
  const auto size = put(static_cast<std::uint32_t>(bytes.size()));
  const auto crc = put(static_cast<std::uint32_t>(crc32(0, bytes.data(), static_cast<uInt>(bytes.size()))));
  bytes.insert(bytes.begin(), size.begin(), size.end());
  bytes.insert(bytes.end(), crc.begin(), crc.end());
  return bytes;
}

/// A message as a datagram of this FRI family.
inline std::vector<std::uint8_t> Datagram(FriFamily family, const google::protobuf::MessageLite& message) {
  return family == FriFamily::k2_7 ? Framed(Bytes(message)) : Bytes(message);
}

/// The message inside a datagram of this FRI family. The frame is not checked here, but by the codec's own
/// tests.
inline std::span<const std::uint8_t> Inside(FriFamily family, std::span<const std::uint8_t> datagram) {
  return family == FriFamily::k2_7 && datagram.size() >= 8 ? datagram.subspan(4, datagram.size() - 8)
                                                           : datagram;
}

/// A client's command as libprotobuf reads it; nullopt if the datagram is no command.
inline std::optional<fri::FRICommandMessage> Command(std::span<const std::uint8_t> datagram,
                                                     FriFamily family = FriFamily::k1) {
  datagram = Inside(family, datagram);
  fri::FRICommandMessage m;
  if (!m.ParseFromArray(datagram.data(), static_cast<int>(datagram.size()))) return std::nullopt;
  if (m.header().messageidentifier() != 0x34001) return std::nullopt;
  return m;
}

/// The first seven of the values; NaN if there are fewer.
inline control::JointArray Values(const fri::JointValues& joints) {
  control::JointArray q;
  q.fill(std::numeric_limits<double>::quiet_NaN());
  std::copy_n(joints.value().begin(), std::min(joints.value_size(), control::kJoints), q.begin());
  return q;
}

/// The message of Monitoring() with an output and a transformation added, so that mutations reach every part
/// of the parser.
inline fri::FRIMonitoringMessage FullMonitoring(std::uint32_t sequence, fri::SessionState state,
                                                FriFamily family) {
  fri::FRIMonitoringMessage m = Monitoring(sequence, state, family);
  auto* io = m.mutable_monitordata()->add_readiorequest();
  io->set_name("Drill.On");
  io->set_type(fri::BOOLEAN);
  io->set_direction(fri::OUTPUT);
  io->set_digitalvalue(1);
  auto* frame = m.add_requestedtransformations();
  if (family == FriFamily::k1) {
    frame->set_name("cup");
    for (const double element : {1., 0., 0., 1., 0., 1., 0., 2., 0., 0., 1., 3.}) frame->add_element(element);
  } else {
    PutPose(frame);
  }
  return m;
}

}  // namespace osteon::io::test
