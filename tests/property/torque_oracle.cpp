#include "tests/property/torque_oracle.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace osteon::property {
namespace {

// Potential energy of the arm's links in gravity, relative to its base at height 0.
double PotentialEnergy_J(const kinematics::ChainParams<7>& arm, const control::JointArray& q) {
  Pose X = Pose::Identity();
  double energy_J = 0.0;
  for (std::size_t i = 0; i < 7; ++i) {
    const kinematics::RevoluteJoint& joint = arm.joints[i];
    X = X * joint.X_PJ * Eigen::AngleAxisd(q[i], joint.axis_J);
    energy_J += 9.81 * joint.link.mass_kg * (X * joint.link.p_LLcm_m).z();
  }
  return energy_J;
}

}  // namespace

control::JointArray GravityByEnergy(const kinematics::ChainParams<7>& arm, const control::JointArray& q) {
  constexpr double kStep_rad = 1e-5;
  control::JointArray gravity_Nm{};
  for (std::size_t i = 0; i < 7; ++i) {
    control::JointArray up = q, down = q;
    up[i] += kStep_rad;
    down[i] -= kStep_rad;
    gravity_Nm[i] = (PotentialEnergy_J(arm, up) - PotentialEnergy_J(arm, down)) / (2.0 * kStep_rad);
  }
  return gravity_Nm;
}

double TorqueOracle::Beyond_Nm(const kinematics::ChainParams<7>& arm, const control::JointArray& q,
                               const control::JointArray& tau_external_Nm) {
  const bool finite = std::all_of(tau_external_Nm.begin(), tau_external_Nm.end(),
                                  [](double tau) { return std::isfinite(tau); });
  const bool had_before = has_before_;
  has_before_ = finite;
  if (!finite) return std::numeric_limits<double>::quiet_NaN();
  double beyond_Nm = -std::numeric_limits<double>::infinity();
  const bool unloaded =
      tau_external_Nm == control::JointArray{} && (!had_before || before_Nm_ == tau_external_Nm);
  if (unloaded) return beyond_Nm;  // without external torque, the arm's own weight is no overload
  const control::JointArray gravity_Nm = GravityByEnergy(arm, q);
  for (std::size_t i = 0; i < 7; ++i) {
    const double change_Nm = had_before ? tau_external_Nm[i] - before_Nm_[i] : 0.0;
    beyond_Nm = std::max(beyond_Nm, std::abs(gravity_Nm[i]) + std::abs(tau_external_Nm[i]) +
                                        std::abs(change_Nm) - arm.joints[i].limits.torque_Nm);
  }
  before_Nm_ = tau_external_Nm;
  return beyond_Nm;
}

}  // namespace osteon::property
