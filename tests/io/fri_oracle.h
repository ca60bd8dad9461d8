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

#include "control/ports.h"

// The arm's side as libprotobuf writes and reads it from the same .proto: independent of nanopb.

namespace osteon::io::test {

inline void PutJoints(double first, fri::JointValues* to) {
  for (int i = 0; i < control::kJoints; ++i) to->add_value(first + 0.125 * i);
}

inline control::JointArray Joints(double first) {
  control::JointArray q{};
  for (int i = 0; i < control::kJoints; ++i) q[static_cast<std::size_t>(i)] = first + 0.125 * i;
  return q;
}

/// A monitoring message as a 1.15 arm sends it: five joint vectors, time stamp, and the ipo position while
/// commanding.
inline fri::FRIMonitoringMessage Monitoring(std::uint32_t sequence, fri::SessionState state) {
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
  PutJoints(0.2, monitor->mutable_commandedjointposition());
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
  if (state >= fri::COMMANDING_WAIT) PutJoints(0.3, ipo->mutable_jointposition());
  ipo->set_clientcommandmode(fri::POSITION);
  ipo->set_overlaytype(fri::JOINT);
  ipo->set_trackingperformance(0.0);
  return m;
}

inline std::vector<std::uint8_t> Bytes(const google::protobuf::MessageLite& message) {
  const std::string text = message.SerializePartialAsString();
  return {text.begin(), text.end()};
}

/// A client's datagram as libprotobuf reads it; empty where it is none.
inline std::optional<fri::FRICommandMessage> Command(std::span<const std::uint8_t> datagram) {
  fri::FRICommandMessage m;
  if (!m.ParseFromArray(datagram.data(), static_cast<int>(datagram.size()))) return std::nullopt;
  if (m.header().messageidentifier() != 0x34001) return std::nullopt;
  return m;
}

/// The first seven of the values; NaN where there are fewer.
inline control::JointArray Values(const fri::JointValues& joints) {
  control::JointArray q;
  q.fill(std::numeric_limits<double>::quiet_NaN());
  std::copy_n(joints.value().begin(), std::min(joints.value_size(), control::kJoints), q.begin());
  return q;
}

}  // namespace osteon::io::test
