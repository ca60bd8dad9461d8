#include "kinematics/check_chain.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include <Eigen/Eigenvalues>

#include "base/number_text.h"

namespace osteon::kinematics {
namespace {

// tolerance of a unit vector's length or a rotation matrix's elements: far above rounding
constexpr double kUnit = 1e-9;
// Tolerance of a principal moment, relative to the inertia's largest element, because published inertias are
// rounded.
constexpr double kInertia = 1e-6;

// @throws std::invalid_argument. @param of  name of the joint or body  @param what  name of the refused value
template <class Value>
[[noreturn]] void Refuse(const std::string& of, const std::string& what, const Value& found,
                         const std::string& accepted) {
  std::ostringstream text;
  text << of << ": " << what << ": found " << found << ", accepted " << accepted;
  throw std::invalid_argument(text.str());
}

void RequireNotNegative(const std::string& of, const std::string& what, double value) {
  if (!(value >= 0.0) || !std::isfinite(value)) Refuse(of, what, value, "0 or more, finite");
}

}  // namespace

void CheckPose(const Pose& X, const std::string& of) {
  const Matrix3 R = X.linear();
  if (!X.translation().allFinite()) Refuse(of, "position", X.translation().transpose(), "finite numbers");
  const double deviation = (R * R.transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff();
  if (!(deviation <= kUnit) || !(R.determinant() > 0.0))
    Refuse(of, "rotation", R.format(Eigen::IOFormat(6, Eigen::DontAlignCols, " ", "; ")),
           "a right-handed rotation matrix");
}

void CheckInertia(const LinkInertia& body, const std::string& of) {
  RequireNotNegative(of, "mass [kg]", body.mass_kg);
  if (!body.p_LLcm_m.allFinite())
    Refuse(of, "centre of mass [m]", body.p_LLcm_m.transpose(), "finite numbers");
  const Matrix3& I = body.I_LLcm_kg_m2;
  const double scale = I.cwiseAbs().maxCoeff();
  if (!I.allFinite() || !((I - I.transpose()).cwiseAbs().maxCoeff() <= kUnit * scale))
    Refuse(of, "inertia [kg m^2]", I.format(Eigen::IOFormat(6, Eigen::DontAlignCols, " ", "; ")),
           "a symmetric matrix");
  const Vector3 moments = Eigen::SelfAdjointEigenSolver<Matrix3>(I, Eigen::EigenvaluesOnly).eigenvalues();
  if (moments[0] < -kInertia * scale || moments[2] > moments[0] + moments[1] + kInertia * scale)
    Refuse(of, "principal moments of inertia [kg m^2]", moments.transpose(),
           "none negative, none greater than the sum of the other two");
}

void CheckJoint(const RevoluteJoint& joint, int number, bool masses) {
  const std::string of = "joint " + std::to_string(number);
  CheckPose(joint.X_PJ, of);
  if (!(std::abs(joint.axis_J.norm() - 1.0) <= kUnit))
    Refuse(of, "length of its axis", joint.axis_J.norm(), "1");
  const JointLimits& limits = joint.limits;
  if (!(limits.lower_rad < limits.upper_rad) || !std::isfinite(limits.lower_rad) ||
      !std::isfinite(limits.upper_rad))
    Refuse(of, "upper limit [rad]", limits.upper_rad,
           "more than the lower limit of " + base::NumberText(limits.lower_rad) + ", both finite");
  RequireNotNegative(of, "velocity limit [rad/s]", limits.velocity_rad_per_s);
  RequireNotNegative(of, "acceleration limit [rad/s^2]", limits.acceleration_rad_per_s2);
  RequireNotNegative(of, "torque limit [Nm]", limits.torque_Nm);
  if (!masses) return;
  CheckInertia(joint.link, of);
  RequireNotNegative(of, "rotor inertia [kg m^2]", joint.rotor_inertia_kg_m2);
  RequireNotNegative(of, "viscous friction [Nms/rad]", joint.friction.viscous_Nms_per_rad);
  RequireNotNegative(of, "Coulomb friction [Nm]", joint.friction.coulomb_Nm);
  if (!(joint.friction.smoothing_rad_per_s > 0.0))
    Refuse(of, "smoothing of its friction [rad/s]", joint.friction.smoothing_rad_per_s, "more than 0");
}

}  // namespace osteon::kinematics
