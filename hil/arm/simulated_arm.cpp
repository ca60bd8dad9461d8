#include "hil/arm/simulated_arm.h"

#include "kinematics/lbr_arm.h"

namespace osteon::hil {
namespace {

using kinematics::JointVector;

// An arm that forces do not deflect. Its external torque is J^T F of the present wrench on the tool.
class StiffArm : public SimulatedArm {
 public:
  StiffArm(const kinematics::LbrParams& lbr, const Vector3& p_FT_m) : arm_(lbr), p_FT_m_(p_FT_m) {}

  [[nodiscard]] JointVector tau_measured_Nm() const OSTEON_RT final { return JointVector::Zero(); }
  [[nodiscard]] JointVector tau_external_Nm() const OSTEON_RT final {
    Eigen::Matrix<double, 6, 1> F;
    F << F_T_B_.f, F_T_B_.t;
    return arm_.JacobianAt(q(), p_FT_m_).transpose() * F;
  }

 protected:
  void SetToolWrench(const Wrench& F_T_B) OSTEON_RT { F_T_B_ = F_T_B; }

 private:
  kinematics::LbrArm arm_;
  Vector3 p_FT_m_;
  Wrench F_T_B_;
};

// ArmLevel::kKinematic.
class KinematicArm final : public StiffArm {
 public:
  KinematicArm(const SimulatedArmParams& params, double period_s)
      : StiffArm(params.lbr, params.p_FT_m), period_s_(period_s), q_(params.q_start) {}

  void Step(const ArmDrive& drive, const Wrench& F_T_B) OSTEON_RT override {
    qd_ = (drive.q_cmd - q_) / period_s_;
    q_ = drive.q_cmd;
    SetToolWrench(F_T_B);
  }
  [[nodiscard]] const JointVector& q() const OSTEON_RT override { return q_; }
  [[nodiscard]] const JointVector& qd() const OSTEON_RT override { return qd_; }

 private:
  double period_s_;
  JointVector q_, qd_{JointVector::Zero()};
};

// ArmLevel::kServo: ServoArm behind the interface SimulatedArm.
class LaggingArm final : public StiffArm {
 public:
  LaggingArm(const SimulatedArmParams& params, double period_s)
      : StiffArm(params.lbr, params.p_FT_m),
        servo_(params.servo, params.lbr.limits, period_s, params.q_start) {}

  void Step(const ArmDrive& drive, const Wrench& F_T_B) OSTEON_RT override {
    servo_.Step(drive.q_cmd);
    SetToolWrench(F_T_B);
  }
  [[nodiscard]] const JointVector& q() const OSTEON_RT override { return servo_.q(); }
  [[nodiscard]] const JointVector& qd() const OSTEON_RT override { return servo_.qd(); }

 private:
  ServoArm servo_;
};

}  // namespace

std::unique_ptr<SimulatedArm> MakeSimulatedArm(const SimulatedArmParams& params, double period_s) {
  switch (params.level) {
    case ArmLevel::kKinematic:
      return std::make_unique<KinematicArm>(params, period_s);
    case ArmLevel::kServo:
      return std::make_unique<LaggingArm>(params, period_s);
    case ArmLevel::kDynamic:
      break;
  }
  return std::make_unique<DynamicArm>(params.dynamic, params.chain, params.gravity_B_m_per_s2, params.p_FT_m,
                                      period_s, params.q_start);
}

}  // namespace osteon::hil
