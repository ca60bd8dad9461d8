#include "control/loop/arm_session.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace osteon::control {
namespace {

// For the measured velocity, a longer gap between two messages counts as this many periods.
constexpr double kMaxPeriods = 10.0;
// A joint that is slower counts as standing still. The limit is above an encoder's step per period, and below
// the speed of a coasting arm.
constexpr double kStands_rad_per_s = 0.02;
constexpr double kSamePeriod_s = 1e-6;  // periods that differ by less are the same
constexpr std::uint8_t kT1 = 0;         // value of ArmState::operation_mode for T1

}  // namespace

bool HasReducedSpeed(const ArmState& state) OSTEON_RT { return state.operation_mode == kT1; }

double MaxJointDifference(const JointArray& a, const JointArray& b) OSTEON_RT {
  double max_rad = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) max_rad = std::max(max_rad, std::abs(a[i] - b[i]));
  return max_rad;
}

ArmSession::ArmSession(const ServoParams& params)
    : params_(params), twist_(params.impedance.twist_filter_s) {}

bool ArmSession::OnMissedMessage() OSTEON_RT {
  missed_ = std::min(missed_ + 1, params_.watchdog.arm_misses);
  return missed_ >= params_.watchdog.arm_misses;
}

void ArmSession::OnMessage(const ArmState& state, const Pose& X_WT, rt::Nanoseconds now) OSTEON_RT {
  missed_ = 0;
  X_WT_ = X_WT;
  if (measured_at_ == 0) {
    twist_.Reset(X_WT);
    q_seen_ = state.q_meas;
  }
  elapsed_s_ = std::min(message_gap_.Step(state), kMaxPeriods) * params_.period_s;
  measured_at_ = now;
  twist_.Step(X_WT, elapsed_s_);
}

void ArmSession::UpdateStandstill(const JointArray& q_meas) OSTEON_RT {
  const bool stood = MaxJointDifference(q_meas, q_seen_) <= kStands_rad_per_s * elapsed_s_;
  standing_ = stood ? std::min(standing_ + 1, kStandingMessages) : 0;
  q_seen_ = q_meas;
}

bool ArmSession::TakesCommands(const ArmState& state, bool moves) const OSTEON_RT {
  const bool allowed = !moves || !commanded_ || state.activation == activation_;
  return state.session == SessionState::kCommandingActive && allowed;
}

bool ArmSession::IsSameActivation(const ArmState& state) const OSTEON_RT {
  return commanded_ && state.session == SessionState::kCommandingActive && state.activation == activation_;
}

bool ArmSession::HasPeriod(const ArmState& state) const OSTEON_RT {
  return std::abs(state.period_s - params_.period_s) < kSamePeriod_s;
}

bool ArmSession::HasCommandMode(CommandMode mode) const OSTEON_RT {
  const bool overlay = mode == CommandMode::kWrench || mode == CommandMode::kTorque;
  return overlay == (params_.law == Law::kImpedance);
}

void ArmSession::StartCommanding(const ArmState& state) OSTEON_RT {
  activation_ = state.activation;
  commanded_ = true;
}

}  // namespace osteon::control
