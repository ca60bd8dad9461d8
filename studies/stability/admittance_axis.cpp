#include "studies/stability/admittance_axis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

namespace osteon::studies {
namespace {

// Returns the parameters unchanged. @throws std::invalid_argument if a parameter is out of range
const AdmittanceRunParams& Validated(const AdmittanceRunParams& params) {
  Validate(params.loop);
  if (!(params.command_loss >= 0.0 && params.command_loss < 1.0))
    throw std::invalid_argument(
        fmt::format("admittance run: command_loss: found {:g}, accepted 0 … 1, not 1", params.command_loss));
  return params;
}

// The shipped arm without a speed limit. The loop uses the arm's first joint as its axis.
hil::ServoArm ArmWithoutLimits(const hil::AdmittanceLoopParams& loop) {
  const hil::ServoArmParams arm = hil::ArmHeldBy(loop.hand, loop.felt_mass_kg, loop.arm).arm;
  std::array<kinematics::JointLimits, 7> unlimited;
  for (kinematics::JointLimits& limits : unlimited)
    limits.velocity_rad_per_s = std::numeric_limits<double>::max();
  return {arm, unlimited, loop.period_s, kinematics::JointVector::Zero()};
}

// A contact model with the plane through W's origin with normal n_W, as an engine would report it.
simulation::ContactModel PlaneModel(const Vector3& n_W, double stiffness_N_per_m) {
  simulation::ContactModel model;
  model.frame = 1;
  model.contact_count = 1;
  model.contacts[0].n_W = n_W;
  model.contacts[0].stiffness_N_per_m = stiffness_N_per_m;
  return model;
}

}  // namespace

// Positions are relative to the rest position, so that small motions keep their precision.
AdmittanceAxis::AdmittanceAxis(const AdmittanceRunParams& params)
    : params_(Validated(params)),
      preload_N_(params.loop.wall.stiffness_N_per_m > 0.0 ? params.preload_N : 0.0),
      rest_m_(preload_N_ > 0.0 ? -preload_N_ / params.loop.wall.stiffness_N_per_m : 0.0),
      R_WT_(ExpRotation({0.3, -0.4, 0.2})),
      arm_(ArmWithoutLimits(params.loop)),
      command_gain_(hil::ArmHeldBy(params.loop.hand, params.loop.felt_mass_kg, params.loop.arm).command_gain),
      felt_(params.loop.sensor_delay),
      poses_(params.loop.wall.age_ticks),
      speeds_(params.loop.wall.age_ticks),
      commands_(params.command_jitter),
      v_c_m_per_s_(params.kick_m_per_s),
      bits_(params.seed),
      plane_(PlaneModel(R_WT_.col(2), params.loop.wall.stiffness_N_per_m)) {
  coupling_.max_stiffness_N_per_m = std::max(1.0, params.loop.wall.stiffness_N_per_m);
  coupling_.damping_Ns_per_m = params.loop.wall.damping_Ns_per_m;
  coupling_state_.fade = 1.0;
  law_.mass_kg.z() = params.loop.mass_kg;
  law_.damping_Ns_per_m.z() = params.loop.damping_Ns_per_m;
  tool_.X_WT.linear() = R_WT_;
  if (params.vibration) vibration_.emplace(*params.vibration, params.loop.period_s);
}

double AdmittanceAxis::Uniform() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }

// Sends the command to the arm, with losses and jitter, and moves the arm by a period.
void AdmittanceAxis::SendCommand() {
  commands_.Push(x_c_m_);
  late_ = params_.command_jitter == 0
              ? 0
              : std::min(late_ + 1, static_cast<int>(Uniform() * (params_.command_jitter + 1)));
  if (params_.command_loss == 0.0 || Uniform() >= params_.command_loss) told_arm_m_ = commands_.at(late_);
  arm_.Step(kinematics::JointVector::Constant(command_gain_ * told_arm_m_));
}

// Force [N] of the hand's spring, damper and mass at the arm's motion, without the preload.
double AdmittanceAxis::HandForce() {
  const hil::AdmittanceLoopParams& p = params_.loop;
  const double x = arm_.q()[0], v = arm_.qd()[0];
  const double a = (v - arm_m_per_s_) / p.period_s;
  arm_m_per_s_ = v;
  return -(p.hand.stiffness_N_per_m * x + p.hand.damping_Ns_per_m * v + p.hand.mass_kg * a);
}

// Force [N] of the shipped coupling along the axis. The coupling is evaluated at the measured position, or at
// the commanded position of LoopWall::age_ticks ago.
double AdmittanceAxis::WallForce(std::int64_t tick) {
  const hil::LoopWall& wall = params_.loop.wall;
  poses_.Push(x_c_m_);
  speeds_.Push(v_c_m_per_s_);
  if (!(wall.stiffness_N_per_m > 0.0)) return 0.0;
  const bool measured = wall.on == hil::WallOn::kMeasured;
  const Vector3 axis_W = R_WT_.col(2);
  Pose X_WT = Pose::Identity();
  X_WT.linear() = R_WT_;
  X_WT.translation() = (rest_m_ + (measured ? arm_.q()[0] : poses_.at(wall.age_ticks))) * axis_W;
  const Twist V_WT{.v = (measured ? arm_.qd()[0] : speeds_.at(wall.age_ticks)) * axis_W,
                   .w = Vector3::Zero()};
  const auto now =
      static_cast<rt::Nanoseconds>(std::llround(1e9 * params_.loop.period_s * static_cast<double>(tick + 1)));
  plane_.pose_stamp = now;
  plane_.frame = static_cast<std::uint64_t>(tick) + 1;
  return axis_W.dot(control::EvaluateCoupling(
                        coupling_, {.model = plane_, .X_WT = X_WT, .V_WT = V_WT, .now = now}, coupling_state_)
                        .F_T_W.f);
}

AxisTick AdmittanceAxis::Step() {
  const double T = params_.loop.period_s;
  const Vector3 axis_W = R_WT_.col(2);
  AxisTick tick{.hand_N = HandForce()};
  double read_N = tick.hand_N;
  // uniform noise with this RMS value: a uniform variable of width 1 has the variance 1 / 12
  if (params_.noise_N > 0.0) read_N += params_.noise_N * std::sqrt(12.0) * (Uniform() - 0.5);
  felt_.Push(read_N);
  tick.wall_N = WallForce(tick_);
  ++tick_;

  const double told_N = felt_.at(params_.loop.sensor_delay);
  tool_.X_WT.translation() = x_c_m_ * axis_W;
  tool_.V_WT.v = v_c_m_per_s_ * axis_W;
  control::AdmittanceParams law = law_;
  if (vibration_) {  // as in ServoLoop
    tick.index = vibration_->Step({.f = (told_N - preload_N_) * axis_W, .t = Vector3::Zero()}, 0.0);
    tick.damping_factor = vibration_->damping_factor();
    tick.reference_N = vibration_->reference_N();
    tool_.V_WT = control::AfterMassChange(tool_.V_WT, vibration_->mass_factor() / mass_factor_);
    mass_factor_ = vibration_->mass_factor();
    law = control::ScaleLaw(law_, mass_factor_, tick.damping_factor);
  }
  const double sum_N = told_N - preload_N_ + tick.wall_N;
  tick.valid = control::StepAdmittance(law, {.f = sum_N * axis_W, .t = Vector3::Zero()}, T, tool_);
  x_c_m_ = axis_W.dot(tool_.X_WT.translation());
  v_c_m_per_s_ = axis_W.dot(tool_.V_WT.v);
  tick.x_m = x_c_m_;
  SendCommand();
  return tick;
}

}  // namespace osteon::studies
