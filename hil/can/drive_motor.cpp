#include "hil/can/drive_motor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace osteon::hil {

DriveMotor::DriveMotor(const DriveMotorParams& params) : params_(params) {
  for (const double value : {params.inertia_kg_m2, params.rated_torque_Nm, params.torque_limit_ratio,
                             params.gear_ratio, params.bandwidth_hz})
    if (!(value > 0.0)) throw std::invalid_argument("drive motor: every parameter has to be positive");
}

void DriveMotor::Step(double dt_s, double target_rad_per_s, double load_Nm) noexcept {
  // PI controller whose gains 2 J w and J w^2 give two equal poles at the bandwidth; its integral stops at
  // the torque limit.
  const double w = 2.0 * std::numbers::pi * params_.bandwidth_hz, J = params_.inertia_kg_m2;
  const double limit = params_.torque_limit_ratio * params_.rated_torque_Nm;
  const double error = target_rad_per_s - speed_;
  const double wanted_Nm = 2.0 * J * w * error + integral_ + J * w * w * error * dt_s;
  torque_ = std::clamp(wanted_Nm, -limit, limit);
  limited_ = torque_ != wanted_Nm;
  if (!limited_) integral_ += J * w * w * error * dt_s;
  Accelerate(dt_s, load_Nm);
}

void DriveMotor::Coast(double dt_s, double load_Nm) noexcept {
  torque_ = integral_ = 0.0;
  limited_ = false;
  Accelerate(dt_s, load_Nm);
}

void DriveMotor::Accelerate(double dt_s, double load_Nm) noexcept {
  const double per_torque = dt_s / params_.inertia_kg_m2;
  const double unbraked = speed_ + per_torque * torque_;
  const double max_loss = per_torque * load_Nm;
  speed_ = std::abs(unbraked) <= max_loss ? 0.0 : unbraked - std::copysign(max_loss, unbraked);
}

}  // namespace osteon::hil
