// What ServoLoop renders within its limits, and which of them acted.

#include <algorithm>

#include "control/servo_loop.h"

namespace osteon::control {

// The coupling within what its spring may store, the cell may render and the arm can hold.
safety::LimitedWrench ServoLoop::LimitCoupling(const CouplingOutput& coupling, const Pose& X_WT,
                                               const Twist& V_WT) OSTEON_RT {
  const Wrench shaped = stabilisers_.Shape(coupling, X_WT, V_WT);
  const double spring_share = stored_energy_limit_.Step(coupling.displacement_W.norm(), coupling.potential_J);
  if (spring_share == 1.0) return arm_->Limit(wrench_limiter_, shaped);
  acting_.Add(safety::Limit::kStoredEnergy);
  safety::LimitedWrench limited =
      arm_->Limit(wrench_limiter_, {.f = spring_share * shaped.f, .t = spring_share * shaped.t});
  limited.share *= spring_share;
  return limited;
}

// What is rendered of the coupling and of the depth limit's resistance: together within what the cell and the
// arm may give.
safety::LimitedWrench ServoLoop::LimitRenderedWrench(const Wrench& F_coupling_T_W, const Vector3& f_depth_W,
                                                     double fade) OSTEON_RT {
  safety::LimitedWrench bounded{.F = F_coupling_T_W};
  if (depth_limit_.acts()) {
    statistics_.least_depth_left_m = std::min(statistics_.least_depth_left_m, depth_limit_.distance_m());
    acting_.Add(safety::Limit::kDepth, depth_limit_.resists());
    if (!f_depth_W.isZero(0.0))
      bounded =
          arm_->Limit(wrench_limiter_, {.f = F_coupling_T_W.f + fade * f_depth_W, .t = F_coupling_T_W.t});
  }
  return bounded;
}

// Only this share of what is rendered gives no more power to the hand than it may.
void ServoLoop::LimitPower(double power_share, safety::LimitedWrench& rendered) OSTEON_RT {
  if (!(power_share < 1.0)) return;
  acting_.Add(safety::Limit::kPower);
  rendered.F = {.f = power_share * rendered.F.f, .t = power_share * rendered.F.t};
  rendered.share *= power_share;
  stabilisers_.ScaleRendered(power_share);
}

// How fast the arm is measured to be, as long as the loop is answerable for it. The way to the start has a
// speed of its own.
void ServoLoop::WatchArmSpeed(const ArmState& state, bool active, TickRecord& record) OSTEON_RT {
  const bool commanded = safety::IsMotion(state_) || safety::Brakes(state_) ||
                         (state_ == safety::CellState::kPaused && Commanded(state));
  if (!active || !commanded) {
    arm_speed_.Reset();
    return;
  }
  const double limit_m_per_s = on_path_ && params_.start ? params_.start->path.tool_speed_m_per_s
                                                         : ToolSpeedLimit_m_per_s(params_, false);
  if (arm_speed_.Check(state, X_WT_meas_.translation(), limit_m_per_s))
    faults_.Latch(safety::Fault::kArmSpeed);
  record.tool_speed_meas_m_per_s = arm_speed_.speed_m_per_s();
  double& peak_m_per_s = statistics_.peak_measured_tool_speed_m_per_s;
  peak_m_per_s = std::max(peak_m_per_s, record.tool_speed_meas_m_per_s);
}

// Of what either law has rendered.
void ServoLoop::CountRendered(const safety::LimitedWrench& limited, double speed_m_per_s, bool twist_limited,
                              bool workspace_limited, double fade, double sensor_share) OSTEON_RT {
  ServoStatistics& s = statistics_;
  s.peak_coupling_force_N = std::max(s.peak_coupling_force_N, limited.F.f.norm());
  s.peak_coupling_torque_Nm = std::max(s.peak_coupling_torque_Nm, limited.F.t.norm());
  s.peak_tool_speed_m_per_s = std::max(s.peak_tool_speed_m_per_s, speed_m_per_s);
  s.least_tank_J = std::min(s.least_tank_J, stabilisers_.tank().energy_J());
  using safety::Limit;
  acting_.Add(Limit::kWrench, limited.share < 1.0);
  acting_.Add(Limit::kArmTorque, limited.arm_share < 1.0);
  acting_.Add(Limit::kStoredEnergy,
              limited.share < 1.0 && wrench_limiter_.max_force_N() < params_.wrench.max_force_N);
  acting_.Add(Limit::kToolSpeed, twist_limited);
  acting_.Add(Limit::kWorkspace, workspace_limited);
  acting_.Add(Limit::kModelAge, fade < 1.0);
  acting_.Add(Limit::kSensorAge, sensor_share < 1.0);
  acting_.Add(Limit::kAgeGovernor, stabilisers_.governor().acted());
  acting_.Add(Limit::kPassivity, stabilisers_.passivity().acted());
  acting_.Add(Limit::kTank, stabilisers_.tank().acted());
}

}  // namespace osteon::control
