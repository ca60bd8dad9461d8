#include "control/excitation/excited_hold.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "base/number_text.h"

namespace osteon::control {
namespace {

constexpr double kSecond_s = 1.0;  // time over which lost messages and answers are counted
// ForceGrows: the force above kSlow_hz is measured in windows of kWindow_s.
constexpr double kWindow_s = 0.1, kSlow_hz = 5.0;
// A window's force has grown if it is more than kGrowth times that of the window before, and above kGrown_N.
constexpr double kGrowth = 1.3, kGrown_N = 5.0;
constexpr int kGrowingWindows = 3;  // number of growing windows in a row that abort the excitation
// longest gap between messages that is counted, in messages; to a longer gap the loop reacts
constexpr int kMaxGap = 100;

using JointMap = Eigen::Map<const Eigen::Matrix<double, kJoints, 1>>;

void Require(bool accepted, const char* name, double found, const char* range) {
  if (!accepted)
    throw std::invalid_argument(std::string("excited hold: ") + name + ": found " + base::NumberText(found) +
                                ", accepted " + range);
}

}  // namespace

const char* Describe(ExcitationAbort abort) {
  switch (abort) {
    case ExcitationAbort::kNone:
      return "";
    case ExcitationAbort::kLeftPause:
      return "the loop left its pause: a fault, a stop or an operator";
    case ExcitationAbort::kArmLeft:
      return "the arm left the state in which it takes commands";
    case ExcitationAbort::kForce:
      return "the force on the sensor passed its limit";
    case ExcitationAbort::kForceGrows:
      return "the force above 5 Hz grew for 0.3 s";
    case ExcitationAbort::kTracking:
      return "tool or joint was too far from where it was commanded";
    case ExcitationAbort::kAnswersLost:
      return "more messages and answers were lost within 1 s than accepted";
    case ExcitationAbort::kSensor:
      return "the force sensor gave no reading that can be used";
  }
  return "";
}

ExcitedHold::ExcitedHold(const ExcitedHoldParams& params)
    : params_(params), path_(params.path, params.period_s) {
  Require(params.sequence_step >= 1, "sequence_step", params.sequence_step, ">= 1");
  Require(params.max_force_N > 0.0 && params.max_force_N <= 200.0, "max_force_N", params.max_force_N,
          "0 … 200, not 0");
  Require(params.max_tracking_m > 0.0, "max_tracking_m", params.max_tracking_m, "> 0");
  Require(params.wait_s > 0.0, "wait_s", params.wait_s, "> 0");
  Require(params.max_lost_share > 0.0 && params.max_lost_share <= 1.0, "max_lost_share",
          params.max_lost_share, "0 … 1, not 0");
  Require(std::abs(params.axis_W.norm() - 1.0) < 1e-9, "axis_W", params.axis_W.norm(), "a length of 1");
  Require(params.joint >= -1 && params.joint < kJoints, "joint", params.joint, "-1 … 6");
  Require(params.joint < 0 || !params.overlay.on, "joint", params.joint, "-1 with an overlay");
  Require(params.max_joint_tracking_rad > 0.0, "max_joint_tracking_rad", params.max_joint_tracking_rad,
          "> 0");
  const OverlayExcitation& overlay = params.overlay;
  if (!overlay.on) return;
  Require(overlay.max_force_N > 0.0 && overlay.max_force_N <= 50.0, "overlay.max_force_N",
          overlay.max_force_N, "0 … 50, not 0");
  Require(overlay.mass_kg > 0.0 && overlay.damping_Ns_per_m >= 0.0 && overlay.stiffness_N_per_m > 0.0,
          "overlay.stiffness_N_per_m", overlay.stiffness_N_per_m, "> 0, with a mass > 0 and a damping >= 0");
  const MultisineState peak = path_.peak();
  // upper bound of the unscaled force: as if all three terms had their peaks at the same time
  const double bound_N = overlay.mass_kg * peak.a_m_per_s2 + overlay.damping_Ns_per_m * peak.v_m_per_s +
                         overlay.stiffness_N_per_m * peak.x_m;
  overlay_scale_ = std::min(1.0, overlay.max_force_N / bound_N);
}

ExcitedHoldStep ExcitedHold::Step(const ExcitedTick& tick) OSTEON_RT {
  if (!tick.received) return step_;
  if (!has_begun_) {
    if (tick.active && tick.state == safety::CellState::kPaused) BeginExcitation(tick);
    sequence_ = tick.sequence;
    return step_;
  }
  // number of messages since the last one that arrived, including lost messages
  const int messages =
      std::clamp(static_cast<int>(tick.sequence - sequence_) / params_.sequence_step, 1, kMaxGap);
  sequence_ = tick.sequence;
  if (abort_ == ExcitationAbort::kNone && !done_) abort_ = Check(tick, step_.x_m);
  if (abort_ == ExcitationAbort::kNone && !done_ && LosesAnswers(tick, messages))
    abort_ = ExcitationAbort::kAnswersLost;
  if (abort_ == ExcitationAbort::kArmLeft) {
    // the arm no longer follows commands, so there is no motion to brake
    step_ = {.path = step_.path, .abort = abort_};
    done_ = true;
    return step_;
  }
  const bool permitted = abort_ == ExcitationAbort::kNone && (!params_.has_interlock || tick.permitted);
  if (!done_) StepPath(permitted, messages);
  step_.abort = abort_;
  done_ = done_ || step_.path.part == ExcitationPart::kDone ||
          (abort_ != ExcitationAbort::kNone && step_.path.at_rest);
  step_.excites = !done_;
  if (done_) step_.f_N = 0.0;
  // Compute the commanded offset of the joints, and the measured offset along the axis or of the joint.
  JointArray moved{};
  for (std::size_t j = 0; j < moved.size(); ++j) {
    if (!params_.overlay.on) step_.offset[j] = params_.direction[j] * step_.x_m;
    moved[j] = tick.q_meas[j] - q_hold_[j];
  }
  step_.y_m = params_.joint < 0 ? params_.axis_W.dot(params_.J_W * JointMap(moved.data()))
                                : moved[static_cast<std::size_t>(params_.joint)];
  return step_;
}

// Advances the path by one period for each message, including messages that were lost.
void ExcitedHold::StepPath(bool permitted, int messages) OSTEON_RT {
  for (int i = 0; i < messages; ++i) {
    step_.path = path_.Step(permitted);
    if (params_.overlay.on) step_.f_N = OverlayForce(step_.path.x_m);
  }
  step_.x_m = step_.path.x_m;
}

// The force for the path's next period: it would move an arm with the assumed properties along the path.
double ExcitedHold::OverlayForce(double x_m) OSTEON_RT {
  const OverlayExcitation& overlay = params_.overlay;
  const double v_m_per_s = (x_m - x_last_m_) / params_.period_s,
               v_before_m_per_s = (x_last_m_ - x_before_last_m_) / params_.period_s;
  const double f_N = overlay.mass_kg * (v_m_per_s - v_before_m_per_s) / params_.period_s +
                     overlay.damping_Ns_per_m * v_m_per_s + overlay.stiffness_N_per_m * x_m;
  x_before_last_m_ = x_last_m_;
  x_last_m_ = x_m;
  return std::clamp(overlay_scale_ * f_N, -overlay.max_force_N, overlay.max_force_N);
}

// One tick of the rest before the excitation. Averages the force: its mean becomes the force's zero. After
// wait_s, the excitation begins at the joint positions that the loop holds.
void ExcitedHold::BeginExcitation(const ExcitedTick& tick) OSTEON_RT {
  if (waited_ > 0 && tick.activation != activation_) waited_ = 0;
  if (waited_ == 0) force_zero_S_N_.setZero();
  activation_ = tick.activation;
  ++waited_;
  force_zero_S_N_ += (tick.force_S_N - force_zero_S_N_) / static_cast<double>(waited_);
  if (static_cast<double>(waited_) * params_.period_s < params_.wait_s) return;
  has_begun_ = true;
  done_ = params_.rests_only;
  if (done_) step_.path.part = ExcitationPart::kDone;
  q_hold_ = tick.q_hold;
  second_lost_ = tick.lost + tick.answers_lost;
}

// Finds the first reason to abort the excitation in this tick, or kNone. LosesAnswers checks lost answers.
// @param x_before_m  offset that the last answer commanded
ExcitationAbort ExcitedHold::Check(const ExcitedTick& tick, double x_before_m) OSTEON_RT {
  if (!tick.active || tick.activation != activation_) return ExcitationAbort::kArmLeft;
  if (tick.state != safety::CellState::kPaused) return ExcitationAbort::kLeftPause;
  if (!tick.sensor_trusted || !tick.force_S_N.allFinite() || !(tick.sensor_age_s <= params_.max_sensor_age_s))
    return ExcitationAbort::kSensor;
  const Vector3 force_S_N = tick.force_S_N - force_zero_S_N_;
  if (!(force_S_N.norm() <= params_.max_force_N)) return ExcitationAbort::kForce;
  if (!Tracks(tick, x_before_m)) return ExcitationAbort::kTracking;
  return ForceGrows(force_S_N) ? ExcitationAbort::kForceGrows : ExcitationAbort::kNone;
}

// Whether tool and joint are near the positions that the last answer commanded.
bool ExcitedHold::Tracks(const ExcitedTick& tick, double x_before_m) const OSTEON_RT {
  JointArray error{};
  // with an overlay, the command does not change: the force moves the tool away from it
  const double commanded_m = params_.overlay.on ? 0.0 : x_before_m;
  for (std::size_t j = 0; j < error.size(); ++j)
    error[j] = tick.q_meas[j] - q_hold_[j] - params_.direction[j] * commanded_m;
  if (!((params_.J_W * JointMap(error.data())).norm() <= params_.max_tracking_m)) return false;
  return params_.joint < 0 ||
         std::abs(error[static_cast<std::size_t>(params_.joint)]) <= params_.max_joint_tracking_rad;
}

// Counts the messages and answers that were lost in the present second. @returns whether they are too many
bool ExcitedHold::LosesAnswers(const ExcitedTick& tick, int messages) OSTEON_RT {
  second_messages_ += messages;
  const double second_periods = kSecond_s / params_.period_s;
  const std::uint32_t lost = tick.lost + tick.answers_lost - second_lost_;
  if (static_cast<double>(lost) > params_.max_lost_share * second_periods) return true;
  if (static_cast<double>(second_messages_) >= second_periods) {
    second_messages_ = 0;
    second_lost_ = tick.lost + tick.answers_lost;
  }
  return false;
}

// Whether the force grows from window to window. Growth means that the loop is unstable, because the
// excitation's own force has a constant level.
bool ExcitedHold::ForceGrows(const Vector3& force_S_N) OSTEON_RT {
  // A first-order low pass yields the slow force; the difference from it is the force above kSlow_hz.
  const double share = 1.0 - std::exp(-2.0 * std::numbers::pi * kSlow_hz * params_.period_s);
  slow_S_N_ += share * (force_S_N - slow_S_N_);
  squares_ += (force_S_N - slow_S_N_).squaredNorm();
  if (static_cast<double>(++window_ticks_) * params_.period_s < kWindow_s) return false;
  const double now_N = std::sqrt(squares_ / window_ticks_);
  growing_ = now_N > kGrown_N && now_N > kGrowth * window_N_ ? growing_ + 1 : 0;
  window_N_ = now_N;
  squares_ = 0.0;
  window_ticks_ = 0;
  return growing_ >= kGrowingWindows;
}

}  // namespace osteon::control
