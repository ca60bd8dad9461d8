#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "io/fri/codec.h"
#include "io/fri/frame.h"
#include "tests/fuzz/targets/fuzz_input.h"

// Claims about monitoring messages of FRI, shared by the fuzz targets fri_decode and fri_session.

namespace osteon::fuzz {

/// Returns the bytes in a frame of FRI 2.7 with a correct CRC-32. Without the right CRC nearly all input
/// would be rejected.
inline std::vector<std::uint8_t> Framed(std::span<const std::uint8_t> body) {
  std::vector<std::uint8_t> datagram(body.size() + io::kFriFrameHead + io::kFriFrameTail);
  std::copy(body.begin(), body.end(), datagram.begin() + io::kFriFrameHead);
  io::Frame(datagram, body.size());
  return datagram;
}

template <std::size_t N>
void ClaimFinite(const std::optional<std::array<double, N>>& values, const char* claim) {
  if (!values) return;
  Claim(std::all_of(values->begin(), values->end(), [](double x) { return std::isfinite(x); }), claim);
}

inline void ClaimName(const io::FriName& name) {
  Claim(name.view().size() <= io::FriName::kMaxLength, "a name has at most 63 characters");
  Claim(name.view().find('\0') == std::string_view::npos, "a name has no NUL");
}

inline void ClaimPose(const std::optional<io::FriPose>& pose, io::FriFamily family) {
  if (!pose) return;
  Claim(family != io::FriFamily::k1, "1.x has no poses");
  ClaimFinite(std::optional(pose->element), "a pose is finite");
  const auto& e = pose->element;
  const double norm = std::hypot(std::hypot(e[3], e[4]), std::hypot(e[5], e[6]));
  Claim(std::abs(norm - 1.0) < 2e-3, "a pose's quaternion has length 1");
  Claim(std::isfinite(pose->redundancy ? pose->redundancy->value : 0.0), "a redundancy is finite");
  ClaimName(pose->name);
}

/// Claims about an accepted message: its numbers are finite, its enumerators exist, and it has all fields
/// that its session state requires.
inline void ClaimAccepted(io::FriFamily family, const io::MonitoringMessage& m) {
  using control::SessionState;
  ClaimFinite(m.q_meas, "q_meas is finite");
  ClaimFinite(m.tau_meas, "tau_meas is finite");
  ClaimFinite(m.q_cmd, "q_cmd is finite");
  ClaimFinite(m.tau_cmd, "tau_cmd is finite");
  ClaimFinite(m.tau_ext, "tau_ext is finite");
  ClaimFinite(m.wire_force, "the force is finite");
  ClaimFinite(m.q_ipo, "q_ipo is finite");
  ClaimPose(m.X_meas, family);
  ClaimPose(m.X_ipo, family);
  Claim(std::isfinite(m.tracking_performance), "the tracking performance is finite");
  Claim(!m.wire_force || family == io::FriFamily::k2_7, "only 2.7 has a force");
  Claim(m.session <= SessionState::kCommandingActive, "the session state exists");
  Claim(m.session == SessionState::kIdle || m.q_meas, "an arm beyond IDLE tells where it is");
  Claim(m.session < SessionState::kCommandingWait || m.q_ipo, "a commanded arm has an interpolator");
  Claim(m.quality <= io::FriQuality::kExcellent, "the quality exists");
  Claim(m.safety <= io::FriSafetyState::kStopLevel2, "the safety state exists");
  Claim(m.operation <= io::FriOperationMode::kAutomatic, "the operation mode exists");
  Claim(m.control <= control::ControlMode::kNone, "the control mode exists");
  Claim(m.overlay <= io::FriOverlay::kCartesian, "the overlay exists");
  Claim(m.command_mode <= (family == io::FriFamily::k1 ? control::CommandMode::kTorque
                                                       : control::CommandMode::kCartesianPose),
        "the command mode exists in this version");
  Claim(m.send_period_ms >= 1 && m.send_period_ms <= 100, "the period is 1 to 100 ms");
  Claim(m.receive_multiplier >= 1 && m.receive_multiplier <= 100, "the multiplier is 1 to 100");
  for (const io::FriDriveState drive : m.drives)
    Claim(drive <= io::FriDriveState::kActive, "the drive state exists");
  for (const io::FriIo& io : m.ios) {
    ClaimName(io.name);
    Claim(io.type <= io::FriIoType::kAnalog, "the type of an input exists");
    Claim(io.direction <= io::FriIoDirection::kOutput, "the direction of an input exists");
    Claim(std::isfinite(io.analog.value_or(0.0)), "an analog input is finite");
  }
  for (const io::FriTransformation& frame : m.transformations) {
    ClaimName(frame.name);
    const Pose X = frame.X;
    Claim(X.matrix().allFinite(), "a frame is finite");
    Claim(std::abs(X.linear().determinant() - 1.0) < 0.01, "a frame is turned, not mirrored or scaled");
  }
}

}  // namespace osteon::fuzz
