#include "hil/fri/fri_server.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace osteon::hil {
namespace {

using control::CommandMode;
using control::ControlMode;
using control::SessionState;
using kinematics::JointVector;

constexpr int kGood = 2;  // value of LinkQuality::level() for GOOD
// number of messages sent in IDLE; the number that a real arm sends is not published
constexpr int kIdleMessages = 10;
constexpr int kWrenchSize = 6;

// Throws std::invalid_argument unless accepted.
void Require(bool accepted, std::string_view name, double found, std::string_view range) {
  if (!accepted)
    throw std::invalid_argument(fmt::format("simulated arm: {}: found {}, accepted {}", name, found, range));
}

control::JointArray ToArray(const JointVector& q) {
  control::JointArray array{};
  std::copy_n(q.data(), control::kJoints, array.begin());
  return array;
}

// Returns the number of answers due in one second. Throws if the send period is not accepted.
int AnswersPerSecond(const FriServerParams& params) {
  Require(params.send_period_ms >= 1 && params.send_period_ms <= 100, "send_period_ms", params.send_period_ms,
          "1 … 100");
  Require(params.receive_multiplier >= 1 && params.receive_multiplier <= 100, "receive_multiplier",
          params.receive_multiplier, "1 … 100");
  return 1000 / (params.send_period_ms * params.receive_multiplier);
}

bool IsCompliant(ControlMode mode) {
  return mode == ControlMode::kCartesianImpedance || mode == ControlMode::kJointImpedance;
}

// The control mode that a command mode requires; the present one if it requires none.
ControlMode ControlModeFor(CommandMode command, ControlMode present) {
  if (command == CommandMode::kWrench) return ControlMode::kCartesianImpedance;
  if (command == CommandMode::kTorque) return ControlMode::kJointImpedance;
  return present == ControlMode::kNone ? ControlMode::kPosition : present;
}

void RequireCommandMode(CommandMode mode) {
  Require(mode == CommandMode::kPosition || mode == CommandMode::kWrench || mode == CommandMode::kTorque,
          "command_mode", static_cast<double>(mode), "1 (POSITION), 2 (WRENCH), 3 (TORQUE)");
}

// Converts a wrench to the wire's order: force, then torque about x, y, z or about z, y, x.
std::array<double, 6> ToWire(const PlainWrench& F, bool torques_zyx) {
  return torques_zyx ? std::array{F.f.x, F.f.y, F.f.z, F.t.z, F.t.y, F.t.x}
                     : std::array{F.f.x, F.f.y, F.f.z, F.t.x, F.t.y, F.t.z};
}

Wrench FromWire(const std::array<double, 6>& wire, bool torques_zyx) {
  const Vector3 t(wire[3], wire[4], wire[5]);
  return {.f = Vector3(wire[0], wire[1], wire[2]), .t = torques_zyx ? Vector3(t.reverse()) : t};
}

}  // namespace

FriServer::FriServer(const FriServerParams& params, const std::array<kinematics::JointLimits, 7>& limits,
                     const JointVector& q_start)
    : params_(params),
      limits_(limits),
      codec_(params.version),
      quality_(params.quality, AnswersPerSecond(params)),
      drives_(params.drive_start_s),
      q_commanded_(q_start),
      q_ipo_(q_start),
      q_measured_(q_start) {
  RequireCommandMode(params.command_mode);
  Require(params.max_axis_delta_rad > 0.0, "max_axis_delta_rad", params.max_axis_delta_rad, "> 0");
  Require(params.drive_start_s >= 0.0, "drive_start_s", params.drive_start_s, ">= 0");
  Require(params.close_s >= 0.0 && params.close_s <= 3600.0, "close_s", params.close_s, "0 … 3600");
  Require(params.external_torque_cutoff_hz >= 0.0, "external_torque_cutoff_hz",
          params.external_torque_cutoff_hz, ">= 0, 0 for no filter");
  Require(params.external_torque_offset_Nm.allFinite(), "external_torque_offset_Nm",
          params.external_torque_offset_Nm.maxCoeff(), "finite");
  Require(params.request_after_good_cycles >= 1, "request_after_good_cycles",
          params.request_after_good_cycles, ">= 1");
  Require(params.activate_after_mirrored_answers >= 1, "activate_after_mirrored_answers",
          params.activate_after_mirrored_answers, ">= 1");
  Require(params.step_margin >= 1.0 && params.step_margin <= 100.0, "step_margin", params.step_margin,
          "1 … 100");
  Require(params.mirror_tolerance_rad > 0.0, "mirror_tolerance_rad", params.mirror_tolerance_rad, "> 0");
  Require(params.tracking_error_zero_rad > 0.0, "tracking_error_zero_rad", params.tracking_error_zero_rad,
          "> 0");
  for (int i = 0; i < control::kJoints; ++i) {
    const kinematics::JointLimits& limit = limits[static_cast<std::size_t>(i)];
    Require(limit.lower_rad < limit.upper_rad, fmt::format("upper position limit of A{} [rad]", i + 1),
            limit.upper_rad, fmt::format("above the lower limit {}", limit.lower_rad));
    Require(limit.velocity_rad_per_s > 0.0, fmt::format("velocity limit of A{} [rad/s]", i + 1),
            limit.velocity_rad_per_s, "> 0");
    Require(q_start[i] >= limit.lower_rad && q_start[i] <= limit.upper_rad,
            fmt::format("start position of A{} [rad]", i + 1), q_start[i],
            fmt::format("{} … {}", limit.lower_rad, limit.upper_rad));
  }
}

void FriServer::Open() {
  quality_.Reset();
  state_ = SessionState::kMonitoringWait;
  was_good_ = has_pending_ = turn_answered_ = turn_excused_ = false;
  program_asks_ = true;
  cycles_in_session_ = good_cycles_ = mirrored_ = cycles_in_turn_ = closing_cycles_ = idle_messages_ = 0;
  stop_ = {};
  Acknowledge();
}

void FriServer::CloseAfter(double seconds) {
  Require(seconds >= 0.0 && seconds <= 3600.0, "seconds until the session closes", seconds, "0 … 3600");
  if (state_ == SessionState::kIdle || closing_cycles_ > 0) return;
  program_asks_ = false;
  if (Commanding()) LeaveCommanding();
  closing_cycles_ = std::max(1, static_cast<int>(std::lround(seconds / period_s())));
}

void FriServer::EmergencyStop(int level) {
  Require(level >= 0 && level <= 2, "stop level", level, "0 … 2");
  SafetyStop(Report(StopReason::kEmergencyStop, 0, level, 2), level);
}

void FriServer::PowerOff() { SafetyStop(Report(StopReason::kPowerOff, 0, 0.0, 0.0), 0); }

void FriServer::Acknowledge() {
  if (drives_.safety() == 0) return;
  drives_.Acknowledge();
  stop_ = {};
  program_asks_ = closing_cycles_ == 0;
  good_cycles_ = 0;
}

bool FriServer::SetModes(ControlMode control_mode, CommandMode command_mode) {
  RequireCommandMode(command_mode);
  if (Commanding()) return false;
  params_.control_mode = control_mode;
  params_.command_mode = command_mode;
  program_asks_ = drives_.safety() == 0 && closing_cycles_ == 0;
  good_cycles_ = 0;
  return true;
}

bool FriServer::Receive(std::span<const std::uint8_t> datagram) {
  const auto command = codec_.Decode(datagram);
  if (!command || counters_.sent == 0 || state_ == SessionState::kIdle) {
    ++counters_.malformed;
    if (!command && codec_.IsOfOtherVersion(datagram)) ++counters_.other_version;
    return false;
  }
  // Sequence numbers wrap at 2^32, so the age in messages is an unsigned difference. If it exceeds half the
  // range, the reflected number belongs to no message sent so far, and the answer is invalid.
  const std::uint32_t messages_ago = sequence_ - command->reflected_sequence;
  if (messages_ago > 0x7fffffffu) {
    ++counters_.malformed;
    return false;
  }
  if (any_answer_ && command->reflected_sequence == answered_sequence_) {
    ++counters_.duplicate;
    return false;
  }
  if (messages_ago >= static_cast<std::uint32_t>(params_.receive_multiplier)) {
    ++counters_.stale;
    return false;
  }
  CountClientSequence(command->sequence);
  client_sequence_ = command->sequence;
  answered_sequence_ = command->reflected_sequence;
  any_answer_ = has_pending_ = true;
  pending_ = *command;
  return true;
}

void FriServer::CountClientSequence(std::uint32_t sequence) {
  const std::uint32_t step = sequence - client_sequence_;
  if (!any_answer_ || step == 1) return;
  if (step == 0 || step > 0x7fffffffu)
    ++counters_.client_back;
  else
    counters_.client_gap += step - 1;
}

// Counts an answer that commands a motion outside the commanding states. Such a motion is ignored silently,
// as on real arms.
void FriServer::CountIgnored() {
  if (!has_pending_ || Commanding() || !pending_.has_joint_position) return;
  const auto q = Eigen::Map<const JointVector>(pending_.q.data());
  const double off_rad = (q - q_commanded_).cwiseAbs().maxCoeff();
  counters_.ignored += !(off_rad <= params_.mirror_tolerance_rad);
}

bool FriServer::HasRequiredFields() const {
  return pending_.has_joint_position &&
         (params_.command_mode != CommandMode::kWrench || pending_.has_wrench) &&
         (params_.command_mode != CommandMode::kTorque || pending_.has_torque);
}

void FriServer::EndCycle(bool client_had_its_time) {
  if (state_ == SessionState::kIdle || counters_.sent == 0) return;
  ++cycles_in_session_;
  ++cycles_since_command_;
  drives_.Step(period_s());
  CountIgnored();
  if (has_pending_ && Commanding() && !HasRequiredFields()) {
    ++counters_.incomplete;
    has_pending_ = false;
  }
  CountAnswer(client_had_its_time);

  switch (state_) {
    case SessionState::kIdle:
      break;
    case SessionState::kMonitoringWait:
    case SessionState::kMonitoringReady:
      StepMonitoring();
      break;
    case SessionState::kCommandingWait:
      StepCommandingWait();
      break;
    case SessionState::kCommandingActive:
      if (has_pending_) ApplyCommand();
      break;
  }
  if (Commanding()) EndOnLosses();
  has_pending_ = false;
}

std::span<const std::uint8_t> FriServer::BeginCycle(const ArmMeasurement& measured, rt::Nanoseconds stamp) {
  if (state_ == SessionState::kIdle && idle_messages_-- <= 0) {
    idle_messages_ = 0;
    return {};
  }
  ++counters_.sent;
  FriMonitoring m;
  m.sequence = ++sequence_;
  m.reflected_sequence = client_sequence_;
  m.session = state_;
  m.quality = static_cast<std::uint8_t>(quality_.level());
  m.safety_state = drives_.safety();
  m.drive_state = static_cast<std::uint8_t>(drives_.state());
  m.control_mode = params_.control_mode;
  m.command_mode = params_.command_mode;
  m.send_period_ms = static_cast<std::uint32_t>(params_.send_period_ms);
  m.receive_multiplier = static_cast<std::uint32_t>(params_.receive_multiplier);
  m.q_meas = ToArray(measured.q);
  m.q_cmd = ToArray(q_commanded_);
  q_measured_ = measured.q;
  X_measured_ = measured.X_BC;
  // first-order low-pass filter
  if (params_.external_torque_cutoff_hz > 0.0)
    tau_estimated_ +=
        (1.0 - std::exp(-2.0 * std::numbers::pi * params_.external_torque_cutoff_hz * period_s())) *
        (measured.tau_ext - tau_estimated_);
  else
    tau_estimated_ = measured.tau_ext;
  m.tau_meas = ToArray(measured.tau_meas);
  m.tau_cmd = ToArray(tau_commanded_);
  m.tau_ext = ToArray(tau_estimated_ + params_.external_torque_offset_Nm);
  m.wire_force = ToWire(measured.F_C_C, params_.torques_zyx);
  m.X_meas = measured.X_BC;
  m.X_ipo = X_ipo_;
  m.has_ipo = Commanding();
  if (m.has_ipo) m.q_ipo = ToArray(q_ipo_);
  if (state_ == SessionState::kCommandingActive) {
    const double error_rad = (q_commanded_ - measured.q).cwiseAbs().maxCoeff();
    m.tracking_performance = std::clamp(1.0 - error_rad / params_.tracking_error_zero_rad, 0.0, 1.0);
  }
  m.stamp = stamp;
  return codec_.Encode(m);
}

bool FriServer::Commanding() const {
  return state_ == SessionState::kCommandingWait || state_ == SessionState::kCommandingActive;
}

void FriServer::CountAnswer(bool client_had_its_time) {
  turn_answered_ |= has_pending_;
  turn_excused_ |= !client_had_its_time;
  if (++cycles_in_turn_ < params_.receive_multiplier) return;
  if (turn_answered_) {
    ++counters_.answered;
    quality_.Add(Answer::kReceived);
  } else if (turn_excused_) {
    ++counters_.excused;
    quality_.Add(Answer::kExcused);
  } else {
    ++counters_.lost;
    quality_.Add(Answer::kLost);
  }
  cycles_in_turn_ = 0;
  turn_answered_ = turn_excused_ = false;
}

void FriServer::StepMonitoring() {
  const bool good = quality_.level() >= kGood;
  was_good_ |= good;
  if (!was_good_ && cycles_in_session_ * period_s() >= params_.quality.good_timeout_s) {
    stop_ = Report(StopReason::kQualityTimeout, 0, 0.0, params_.quality.good_timeout_s);
    EndSession();
    return;
  }
  state_ = good ? SessionState::kMonitoringReady : SessionState::kMonitoringWait;
  if (closing_cycles_ > 0 && --closing_cycles_ == 0) {
    EndSession();
    return;
  }
  good_cycles_ = good && drives_.ready() ? good_cycles_ + 1 : 0;
  if (program_asks_ && good_cycles_ > params_.request_after_good_cycles) AskForCommanding();
}

void FriServer::EndSession() {
  state_ = SessionState::kIdle;
  idle_messages_ = params_.session_end == SessionEnd::kIdleMessages ? kIdleMessages : 0;
}

void FriServer::AskForCommanding() {
  const ControlMode needed = ControlModeFor(params_.command_mode, params_.control_mode);
  if (params_.control_mode != needed) {
    stop_ = Report(StopReason::kControlMode, 0, static_cast<double>(params_.control_mode),
                   static_cast<double>(needed));
    program_asks_ = false;
    return;
  }
  state_ = SessionState::kCommandingWait;
  q_ipo_ = q_commanded_;
  X_ipo_ = X_measured_;
  mirrored_ = 0;
}

void FriServer::StepCommandingWait() {
  if (has_pending_) {
    if (pending_.joint_count != control::kJoints)
      return SafetyStop(StopReason::kCount, 0, pending_.joint_count, control::kJoints);
    for (int i = 0; i < control::kJoints; ++i) {
      const double off_rad = std::abs(pending_.q[static_cast<std::size_t>(i)] - q_ipo_[i]);
      if (!(off_rad <= params_.mirror_tolerance_rad))  // also true for NaN
        return SafetyStop(StopReason::kNotMirrored, i + 1, off_rad, params_.mirror_tolerance_rad);
    }
    ++mirrored_;
  }
  if (quality_.level() < kGood) {
    (void)ReportLosses();
    LeaveCommanding();
  } else if (mirrored_ >= params_.activate_after_mirrored_answers) {
    state_ = SessionState::kCommandingActive;
    cycles_since_command_ = 0;
  }
}

void FriServer::ApplyCommand() {
  if (pending_.joint_count != control::kJoints)
    return SafetyStop(StopReason::kCount, 0, pending_.joint_count, control::kJoints);
  for (int i = 0; i < control::kJoints; ++i) {
    const double q_rad = pending_.q[static_cast<std::size_t>(i)];
    const kinematics::JointLimits& limit = limits_[static_cast<std::size_t>(i)];
    if (!std::isfinite(q_rad)) return SafetyStop(StopReason::kNotFinite, i + 1, q_rad, limit.upper_rad);
    if (q_rad > limit.upper_rad) return SafetyStop(StopReason::kJointLimit, i + 1, q_rad, limit.upper_rad);
    if (q_rad < limit.lower_rad) return SafetyStop(StopReason::kJointLimit, i + 1, q_rad, limit.lower_rad);
    const double step_rad = std::abs(q_rad - q_commanded_[i]);
    const double max_step_rad =
        limit.velocity_rad_per_s * period_s() * cycles_since_command_ * params_.step_margin;
    if (step_rad > max_step_rad) return SafetyStop(StopReason::kJointStep, i + 1, step_rad, max_step_rad);
    const double delta_rad = std::abs(q_rad - q_measured_[i]);
    if (IsCompliant(params_.control_mode) && delta_rad > params_.max_axis_delta_rad)
      return SafetyStop(StopReason::kAxisDelta, i + 1, delta_rad, params_.max_axis_delta_rad);
  }
  if (!ApplyOverlay()) return;
  q_commanded_ = Eigen::Map<const JointVector>(pending_.q.data());
  cycles_since_command_ = 0;
}

// Applies the wrench or torque overlay that the command mode requires. Returns false if invalid values caused
// a safety stop.
bool FriServer::ApplyOverlay() {
  if (params_.command_mode == CommandMode::kWrench) {
    if (pending_.wrench_count != kWrenchSize) {
      SafetyStop(StopReason::kCount, 0, pending_.wrench_count, kWrenchSize);
      return false;
    }
    for (const double element : pending_.wire_wrench)
      if (!std::isfinite(element)) {
        SafetyStop(StopReason::kNotFinite, 0, element, 0.0);
        return false;
      }
    F_commanded_ = FromWire(pending_.wire_wrench, params_.torques_zyx);
  }
  if (params_.command_mode == CommandMode::kTorque) {
    if (pending_.torque_count != control::kJoints) {
      SafetyStop(StopReason::kCount, 0, pending_.torque_count, control::kJoints);
      return false;
    }
    for (int i = 0; i < control::kJoints; ++i) {
      const double tau_Nm = pending_.tau[static_cast<std::size_t>(i)];
      if (!std::isfinite(tau_Nm)) {
        SafetyStop(StopReason::kNotFinite, i + 1, tau_Nm, 0.0);
        return false;
      }
    }
    tau_commanded_ = Eigen::Map<const JointVector>(pending_.tau.data());
  }
  return true;
}

bool FriServer::ReportLosses() {
  if (quality_.TooManyInARow())
    stop_ =
        Report(StopReason::kLostInARow, 0, quality_.lost_in_a_row(), params_.quality.end_after_lost_in_a_row);
  else if (quality_.TooManyPerSecond())
    stop_ =
        Report(StopReason::kLostPerSecond, 0, quality_.lost_per_s(), params_.quality.end_after_lost_per_s);
  else
    return false;
  return true;
}

void FriServer::EndOnLosses() {
  if (!ReportLosses()) return;
  program_asks_ = params_.request_again_after_loss;
  LeaveCommanding();
}

void FriServer::LeaveCommanding() {
  state_ = quality_.level() >= kGood ? SessionState::kMonitoringReady : SessionState::kMonitoringWait;
  good_cycles_ = 0;
  F_commanded_ = {};
  tau_commanded_.setZero();
}

void FriServer::SafetyStop(StopReason reason, int joint, double found, double accepted) {
  SafetyStop(Report(reason, joint, found, accepted), 1);
}

void FriServer::SafetyStop(const StopReport& report, int level) {
  stop_ = report;
  drives_.Stop(level);
  program_asks_ = false;
  if (Commanding()) LeaveCommanding();
}

StopReport FriServer::Report(StopReason reason, int joint, double found, double accepted) const {
  return {.reason = reason, .sequence = sequence_, .joint = joint, .found = found, .accepted = accepted};
}

}  // namespace osteon::hil
