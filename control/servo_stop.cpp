// How ServoLoop comes to rest.

#include <algorithm>

#include "control/servo_loop.h"
#include "control/twist_parts.h"

namespace osteon::control {
namespace {

constexpr double kRest_m_per_s = 1e-9, kRest_rad_per_s = 1e-9;

}  // namespace

void ServoLoop::Brake() OSTEON_RT {
  if (params_.law == Law::kImpedance) {
    BrakeImpedance();
    return;
  }
  if (arm_->braking_joints()) {
    BrakeJoints();
    return;
  }
  // the whole twist by one factor: the longer of the two halves' braking times counts
  const double dt_s = params_.period_s;
  const double time_s = std::max(V_WT_.v.norm() / params_.stop_deceleration_m_per_s2,
                                 V_WT_.w.norm() / params_.stop_deceleration_rad_per_s2);
  V_WT_ = Scaled(V_WT_, time_s > dt_s ? 1.0 - dt_s / time_s : 0.0);
  // a turn that takes longer to stop does not carry the apex over its bound
  V_WT_.v = workspace_.Limit(arm_->X_WT().translation(), V_WT_.v, dt_s).v_WT;
  if (V_WT_.v.norm() < kRest_m_per_s && V_WT_.w.norm() < kRest_rad_per_s) {
    TakeRest();
    return;
  }
  bool limited = false;
  if (!Follow(limited)) BrakeJoints();
}

void ServoLoop::BrakeJoints() OSTEON_RT {
  const Vector3 p_before = arm_->X_WT().translation();
  const bool rests = arm_->BrakeJoints();
  V_WT_ = {.v = (arm_->X_WT().translation() - p_before) / params_.period_s, .w = Vector3::Zero()};
  if (!rests) return;
  TakeRest();
}

// A stop 2: as long as the tool is not at rest, whatever ends rendering makes a stop 1 of it.
void ServoLoop::BrakeForPause(const CellReadings& readings, const simulation::ContactModel& model,
                              rt::Nanoseconds now, TickRecord& record) OSTEON_RT {
  const Wrench F_operator_T_W = TakeSensor(readings, record);
  SuperviseDevices(record.model_age_s, record.sensor_age_s, readings, now);
  SuperviseHand(F_operator_T_W);
  if (model.status == simulation::EngineStatus::kDeviceLost) faults_.Latch(safety::Fault::kDevice);
  if (faults_.Any()) Take(safety::CellEvent::kFault);
  if (!on_path_) Brake();
}

}  // namespace osteon::control
