#include "studies/bench/tick_parts.h"

#include "control/laws/twist_parts.h"

namespace osteon::studies {
namespace {

double MicrosecondsSince(rt::Nanoseconds begun) {
  return 1e-3 * static_cast<double>(rt::MonotonicNow() - begun);
}

}  // namespace

TickParts::TickParts(const control::ServoParams& servo, const kinematics::LbrParams& robot, const Pose& X_WB,
                     const Pose& X_FT)
    : servo_(servo),
      arm_(robot),
      X_WB_(X_WB),
      X_BW_(X_WB.inverse()),
      X_FT_(X_FT),
      body_(*servo.arm_body, X_WB.linear().transpose() * kinematics::kGravity_W_m_per_s2),
      limiter_(servo.wrench),
      motion_(control::DifferentialInverseParamsOf<7>(servo)),
      guard_(servo.joints) {
  wanted_load_.load = servo.posture_load;
  wanted_load_.p_F = X_FT.translation();
  wanted_load_.axis_F = X_FT.linear().col(2);
  for (int i = 0; i < 7; ++i)
    wanted_load_.torque_limit_Nm[i] = servo.arm_body->joints[static_cast<std::size_t>(i)].limits.torque_Nm;
}

std::array<double, TickParts::kCount> TickParts::Time(const TickPartsInput& input,
                                                      const simulation::ContactModel& model) {
  std::array<double, kCount> us{};
  const double dt_s = servo_.period_s;

  // tool pose, measured and commanded
  rt::Nanoseconds begun = rt::MonotonicNow();
  const Pose X_WT = X_WB_ * arm_.FlangePose(input.q) * X_FT_;
  sink_ = (X_WB_ * arm_.FlangePose(input.q + dt_s * qd_before_) * X_FT_).translation().x();
  us[0] = MicrosecondsSince(begun);

  // force of the virtual coupling
  begun = rt::MonotonicNow();
  const control::CouplingOutput coupling = control::EvaluateCoupling(
      servo_.coupling,
      {.model = model, .X_WT = X_WT, .V_WT = input.V_WT, .now = input.now, .spindle_turns = true}, coupling_);
  us[1] = MicrosecondsSince(begun);
  active_contacts_ = coupling.active_count;

  // the cell's limits, and the wrench that the arm can hold here
  begun = rt::MonotonicNow();
  const kinematics::Jacobian J_B = arm_.JacobianAt(input.q, X_FT_.translation());
  kinematics::Jacobian J_W;
  J_W.topRows<3>() = X_WB_.linear() * J_B.topRows<3>();
  J_W.bottomRows<3>() = X_WB_.linear() * J_B.bottomRows<3>();
  const kinematics::JointVector gravity_Nm = body_.Gravity(input.q);
  sink_ = limiter_
              .Limit(coupling.F_T_W,
                     {J_W, gravity_Nm, wanted_load_.torque_limit_Nm, kinematics::GravityHelp::kNotCounted})
              .share;
  us[2] = MicrosecondsSince(begun);

  // the elbow's motion toward the posture that holds the load best
  begun = rt::MonotonicNow();
  kinematics::JointVector q_inverse = input.q;
  const double arm_angle_rad = arm_.ArmAngle(input.q);
  const double held =
      kinematics::HeldLoad<7>(wanted_load_, J_B, gravity_Nm, X_BW_.linear() * X_WT.linear().col(2)).value;
  const kinematics::LoadPreference<7> load = kinematics::LoadGradientMotion<7>(
      servo_.posture, body_, wanted_load_, {.q = input.q, .n = null_direction_, .held = held});
  sink_ =
      arm_.Inverse(X_BW_ * X_WT * X_FT_.inverse(), arm_angle_rad, input.q, q_inverse) ? q_inverse[0] : 0.0;
  us[3] = MicrosecondsSince(begun);

  // joint velocities for the tool's twist
  begun = rt::MonotonicNow();
  kinematics::MotionInput<7> wanted;
  wanted.J = J_B;
  wanted.V_BT = control::ExpressedIn(X_BW_.linear(), input.V_WT);
  wanted.q = input.q;
  wanted.qd_before = qd_before_;
  wanted.qd_null = load.qd;
  wanted.dt_s = dt_s;
  wanted.U_before = directions_;
  const kinematics::MotionOutput<7> moves = motion_.Step(wanted);
  us[4] = MicrosecondsSince(begun);
  qd_before_ = moves.qd;
  null_direction_ = moves.null_direction;
  directions_ = moves.U;

  begun = rt::MonotonicNow();
  sink_ = guard_.Limit(input.q, dt_s * moves.qd, dt_s).share;
  us[5] = MicrosecondsSince(begun);
  return us;
}

}  // namespace osteon::studies
