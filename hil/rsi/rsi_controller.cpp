#include "hil/rsi/rsi_controller.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "base/units.h"
#include "hil/fri/fri_stop.h"

namespace osteon::hil {
namespace {

kinematics::JointVectorN<6> ToRadians(const Six& axes_deg) {
  return kDegree * Eigen::Map<const kinematics::JointVectorN<6>>(axes_deg.data());
}

template <class Joints>
Six ToDegrees(const Joints& q) {
  Six axes_deg;
  for (std::size_t i = 0; i < 6; ++i) axes_deg[i] = q[static_cast<int>(i)] / kDegree;
  return axes_deg;
}

// Appends a seventh joint to six joints, for ServoArm.
kinematics::JointVector PadToSeven(const kinematics::JointVectorN<6>& q) {
  kinematics::JointVector seven = kinematics::JointVector::Zero();
  seven.head<6>() = q;
  return seven;
}

// Appends the limits of a seventh joint to those of six joints, for ServoArm.
std::array<kinematics::JointLimits, 7> PadLimitsToSeven(const kinematics::OrthoParallelParams& arm) {
  std::array<kinematics::JointLimits, 7> limits{};
  std::copy(arm.limits.begin(), arm.limits.end(), limits.begin());
  limits[6] = {.lower_rad = -1.0, .upper_rad = 1.0, .velocity_rad_per_s = 1.0};
  return limits;
}

// Rotation of a KUKA frame X Y Z A B C [mm, deg].
Matrix3 RotationOf(const Six& frame) {
  return (Eigen::AngleAxisd(frame[3] * kDegree, Vector3::UnitZ()) *
          Eigen::AngleAxisd(frame[4] * kDegree, Vector3::UnitY()) *
          Eigen::AngleAxisd(frame[5] * kDegree, Vector3::UnitX()))
      .toRotationMatrix();
}

// Returns the KUKA frame X Y Z A B C [mm, deg] of a pose.
Six FrameOf(const Pose& X) {
  const Matrix3& R = X.linear();
  const Vector3 p_mm = 1e3 * X.translation();
  return {p_mm.x(),
          p_mm.y(),
          p_mm.z(),
          std::atan2(R(1, 0), R(0, 0)) / kDegree,
          std::asin(std::clamp(-R(2, 0), -1.0, 1.0)) / kDegree,
          std::atan2(R(2, 1), R(2, 2)) / kDegree};
}

// Throws std::invalid_argument unless accepted.
void Require(bool accepted, const std::string& name, double found, std::string_view range) {
  if (!accepted)
    throw std::invalid_argument(fmt::format("simulated KR: {}: found {}, accepted {}", name, found, range));
}

// Returns the parameters; throws if one is not accepted.
const RsiControllerParams& Checked(const RsiControllerParams& params) {
  Require(params.cycle_ms == 4 || params.cycle_ms == 12, "cycle_ms", params.cycle_ms, "4 or 12");
  Require(params.timeout_cycles >= 1, "timeout_cycles", params.timeout_cycles, ">= 1");
  Require(params.level != ArmLevel::kDynamic, "level", static_cast<double>(params.level),
          "0 or 1: no masses of a KR are published");
  Require(params.axis_speed_ratio > 0.0, "axis_speed_ratio", params.axis_speed_ratio, "> 0");
  Require(params.ipoc_step >= 1, "ipoc_step", params.ipoc_step, ">= 1: 1, or the cycle's milliseconds");
  for (std::size_t i = 0; i < 6; ++i) {
    const auto& limit = params.arm.limits[i];
    Require(params.range[i] > 0.0, fmt::format("range {}", i + 1), params.range[i], "> 0");
    Require(
        params.start_deg[i] * kDegree >= limit.lower_rad && params.start_deg[i] * kDegree <= limit.upper_rad,
        fmt::format("start_deg of A{}", i + 1), params.start_deg[i],
        fmt::format("{:g} … {:g}", limit.lower_rad / kDegree, limit.upper_rad / kDegree));
  }
  return params;
}

}  // namespace

std::string Describe(const RsiStopReport& stop) {
  switch (stop.reason) {
    case RsiStopReason::kNone:
      return "none";
    case RsiStopReason::kTimeout:
      return fmt::format("timeout: {:g} answers late, RSI ends at {:g}", stop.found, stop.accepted);
    case RsiStopReason::kAskedFor:
      return "asked for by <Stop>1</Stop>";
    case RsiStopReason::kCorrectionRange:
      return fmt::format("correction range: number {} corrected by {:g}, accepted {:g}", stop.axis,
                         stop.found, stop.accepted);
    case RsiStopReason::kAxisLimit:
      return fmt::format("axis limit: A{} set to {:g} deg, accepted at {} {:g}", stop.axis, stop.found,
                         stop.found > stop.accepted ? "most" : "least", stop.accepted);
    case RsiStopReason::kAxisSpeed:
      return fmt::format("axis speed: A{} told to move at {:.0f} deg/s, accepted {:g} (KSS01102)", stop.axis,
                         stop.found, stop.accepted);
    case RsiStopReason::kOutOfReach:
      return "out of reach: no posture for the corrected pose";
    case RsiStopReason::kPowerOff:
      return kNoPower;
  }
  return "unknown";
}

RsiController::RsiController(const RsiControllerParams& params)
    : params_(Checked(params)),
      arm_(params.arm),
      chain_(kinematics::ChainFrom(params.arm)),
      servo_(params.servo, PadLimitsToSeven(params.arm), 1e-3 * params.cycle_ms,
             PadToSeven(ToRadians(params.start_deg))),
      start_deg_(params.start_deg),
      q_set_(ToRadians(params.start_deg)),
      q_(q_set_),
      X_BF_start_(chain_.FlangePose(q_set_)),
      first_ipoc_(params.first_ipoc) {
  state_.ipoc = first_ipoc_ - static_cast<std::uint64_t>(params_.ipoc_step);
  state_.axes_set_deg = state_.axes_measured_deg = start_deg_;
}

void RsiController::Restart() {
  // By now the arm rests at its last set point. RSI begins there, with a new IPOC.
  start_deg_ = ToDegrees(q_set_);
  X_BF_start_ = chain_.FlangePose(q_set_);
  last_ = state_.correction = {};
  answered_ = false;
  state_.running = true;
  state_.delay = excused_delay_ = 0;
  state_.stop = {};
  state_.counters = {};
  // an IPOC that counts messages starts at 1 again; one that counts time continues
  first_ipoc_ = params_.ipoc_step == 1 ? 1 : state_.ipoc + 10'000u;
  state_.ipoc = first_ipoc_ - static_cast<std::uint64_t>(params_.ipoc_step);
}

bool RsiController::Receive(std::span<const std::uint8_t> datagram) {
  RsiCounters& counters = state_.counters;
  const auto answer = ReadSen(datagram, params_.format, params_.cartesian);
  if (!answer) {
    last_error_ = answer.error();
    ++counters.malformed;
    return false;
  }
  if (answer->ipoc != state_.ipoc || counters.sent == 0 || !state_.running) {
    const bool is_earlier = answer->ipoc < state_.ipoc && answer->ipoc >= first_ipoc_;
    ++(is_earlier ? counters.late : counters.wrong_ipoc);
    return false;
  }
  if (answered_) {
    ++counters.duplicate;
    return false;
  }
  answer_ = *answer;
  answered_ = true;
  return true;
}

void RsiController::PowerOff() {
  if (state_.running) End(RsiStopReason::kPowerOff, 0, 0.0, 0.0);
}

std::span<const std::uint8_t> RsiController::Step(bool client_had_its_time) {
  if (state_.running && state_.counters.sent > 0) Judge(client_had_its_time);
  Drive();
  state_.axes_set_deg = ToDegrees(q_set_);
  state_.axes_measured_deg = ToDegrees(q_);
  if (!state_.running) return {};

  state_.ipoc += static_cast<std::uint64_t>(params_.ipoc_step);
  ++state_.counters.sent;
  answered_ = false;
  text_ = WriteRob({.format = params_.format,
                    .pose_measured = FrameOf(chain_.FlangePose(q_)),
                    .pose_set = FrameOf(chain_.FlangePose(q_set_)),
                    .axes_measured = state_.axes_measured_deg,
                    .axes_set = state_.axes_set_deg,
                    .delay = state_.delay,
                    .ipoc = state_.ipoc});
  return {reinterpret_cast<const std::uint8_t*>(text_.data()), text_.size()};
}

// Ends a cycle: updates the applied correction from the cycle's answer, or because there was none.
void RsiController::Judge(bool client_had_its_time) {
  if (answered_) {
    ++state_.counters.answered;
    if (params_.delay_in_a_row) state_.delay = excused_delay_ = 0;
    if (answer_.stop) return End(RsiStopReason::kAskedFor, 0, 1.0, 0.0);
    last_ = answer_.correction;
  } else {
    ++state_.delay;
    if (client_had_its_time) {
      ++state_.counters.missed;
    } else {
      ++state_.counters.excused;
      ++excused_delay_;
    }
    const std::uint32_t late = state_.delay - excused_delay_;
    if (late >= static_cast<std::uint32_t>(params_.timeout_cycles))
      return End(RsiStopReason::kTimeout, 0, late, params_.timeout_cycles);
  }
  const Six correction = answered_ || params_.hold_on ? last_ : Six{};
  for (std::size_t i = 0; i < 6; ++i)
    state_.correction[i] = correction[i] + (params_.absolute ? 0.0 : state_.correction[i]);
  ApplyCorrection();
}

// Applies the monitors, and computes the set point from the applied correction.
void RsiController::ApplyCorrection() {
  const Six& correction = state_.correction;
  for (std::size_t i = 0; i < 6; ++i)
    if (!(std::abs(correction[i]) <= params_.range[i]))
      return End(RsiStopReason::kCorrectionRange, static_cast<int>(i) + 1, correction[i], params_.range[i]);

  kinematics::JointVectorN<6> q = q_set_;
  if (params_.cartesian) {
    Pose X_BF = X_BF_start_;
    X_BF.translation() += 1e-3 * Vector3(correction[0], correction[1], correction[2]);
    X_BF.linear() = RotationOf(correction) * X_BF_start_.linear();
    if (!arm_.Inverse(X_BF, q_set_, q)) return End(RsiStopReason::kOutOfReach, 0, 0.0, 0.0);
  } else {
    Six axes_deg;
    for (std::size_t i = 0; i < 6; ++i) axes_deg[i] = start_deg_[i] + correction[i];
    q = ToRadians(axes_deg);
  }
  for (std::size_t i = 0; i < 6; ++i) {
    const auto& limit = params_.arm.limits[i];
    const double axis_rad = q[static_cast<int>(i)];
    if (axis_rad < limit.lower_rad || axis_rad > limit.upper_rad)
      return End(RsiStopReason::kAxisLimit, static_cast<int>(i) + 1, axis_rad / kDegree,
                 (axis_rad < limit.lower_rad ? limit.lower_rad : limit.upper_rad) / kDegree);
    const double speed_rad_per_s = std::abs(axis_rad - q_set_[static_cast<int>(i)]) / period_s();
    const double max_rad_per_s = params_.axis_speed_ratio * limit.velocity_rad_per_s;
    if (speed_rad_per_s > max_rad_per_s)
      return End(RsiStopReason::kAxisSpeed, static_cast<int>(i) + 1, speed_rad_per_s / kDegree,
                 max_rad_per_s / kDegree);
  }
  q_set_ = q;
}

// Advances the arm by one cycle toward its set point.
void RsiController::Drive() {
  if (params_.level == ArmLevel::kKinematic) {
    qd_ = (q_set_ - q_) / period_s();
    q_ = q_set_;
    return;
  }
  servo_.Step(PadToSeven(q_set_));
  q_ = servo_.q().head<6>();
  qd_ = servo_.qd().head<6>();
}

// Ends RSI; the set point does not change.
void RsiController::End(RsiStopReason reason, int axis, double found, double accepted) {
  state_.running = false;
  state_.stop = {.reason = reason, .axis = axis, .found = found, .accepted = accepted};
}

}  // namespace osteon::hil
