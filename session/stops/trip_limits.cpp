#include "session/stops/trip_limits.h"

#include <algorithm>
#include <memory>

#include "control/arm/arm_speed_watch.h"
#include "kinematics/lbr_arm.h"
#include "kinematics/ortho_parallel_arm.h"
#include "kinematics/serial_chain.h"
#include "session/run/cell_run.h"

namespace osteon::session {
namespace {

using control::TickRecord;

// Returns a function that computes the position of apex, flange or elbow in W from a tick's joint positions:
// the measured ones under the impedance law, otherwise the commanded ones. @tparam Arm  kinematics::LbrArm,
// OrthoParallelArm
template <class Arm>
auto PointsOf(std::shared_ptr<const Arm> arm, const config::CellConfig& cell) {
  const bool measured = cell.servo.law == control::Law::kImpedance;
  return [arm = std::move(arm), X_WB = cell.X_WB, X_FT = cell.tool.X_FT, measured](
             const TickRecord& tick, safety::ZonePoint point) -> Vector3 {
    typename Arm::Joints q;
    std::copy_n((measured ? tick.q_meas : tick.q_cmd).begin(), Arm::kJoints, q.data());
    const auto points = arm->Points(q);
    switch (point) {
      case safety::ZonePoint::kApex:
        return X_WB * (points.X_BF * X_FT.translation());
      case safety::ZonePoint::kFlange:
        return X_WB * points.X_BF.translation();
      case safety::ZonePoint::kElbow:
        break;
    }
    return X_WB * points.p_BElbow;
  };
}

}  // namespace

TripLimits TripLimitsOf(const config::CellConfig& cell, bool virtual_time) {
  TripLimits limits{.servo = cell.servo};
  limits.arm_silence_s =
      cell.servo.watchdog.arm_misses * cell.servo.period_s * (virtual_time ? 1.0 : kArmDeadlinePeriods);
  limits.arm_speed_ratio = control::ArmSpeedParams{}.margin;
  if (const config::LbrConfig* lbr = cell.robot.lbr())
    limits.p_WP = PointsOf(std::make_shared<const kinematics::LbrArm>(lbr->params), cell);
  else
    limits.p_WP =
        PointsOf(std::make_shared<const kinematics::OrthoParallelArm>(cell.robot.six_axis()->params), cell);
  if (cell.servo.arm_body && cell.servo.arm_body->has_masses) {
    const Vector3 g_B = cell.X_WB.linear().transpose() * kinematics::kGravity_W_m_per_s2;
    limits.gravity_Nm = [chain = std::make_shared<const kinematics::SerialChain<7>>(
                             *cell.servo.arm_body, g_B)](const control::JointArray& q_rad) {
      control::JointArray torques_Nm{};
      const kinematics::JointVector gravity_Nm =
          chain->Gravity(Eigen::Map<const kinematics::JointVector>(q_rad.data()));
      std::copy_n(gravity_Nm.data(), torques_Nm.size(), torques_Nm.begin());
      return torques_Nm;
    };
  }
  return limits;
}

}  // namespace osteon::session
