#include "hil/loops/mount_rule.h"

#include <limits>

#include <Eigen/Eigenvalues>

namespace osteon::hil {
namespace {

// Largest eigenvalue of [r]^T I^-1 [r]: the bone's rotation adds it to the inverse effective mass at a point
// with lever r.
double InverseMassOfTurning(const control::BoneMountParams& mount, const Vector3& r) {
  Matrix3 cross;
  cross << 0.0, -r.z(), r.y(), r.z(), 0.0, -r.x(), -r.y(), r.x(), 0.0;
  const Matrix3 turning = cross.transpose() * mount.inertia_kg_m2.cwiseInverse().asDiagonal() * cross;
  return Eigen::SelfAdjointEigenSolver<Matrix3>(turning, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
}

}  // namespace

MassRule CheckMass(AdmittanceLoopParams rigid, double stiffness_N_per_m,
                   const control::BoneMountParams& mount, const Vector3& p_W_m) {
  const double turning = InverseMassOfTurning(mount, p_W_m - mount.p_WMo_m);
  MassRule rule{.stiffness_N_per_m =
                    stiffness_N_per_m * (1.0 + rigid.mass_kg * (1.0 / mount.mass_kg + turning))};
  rigid.wall = {};
  const Boundary boundary = MaxWallStiffness(
      rigid, {.from = stiffness_N_per_m, .to = rule.stiffness_N_per_m, .factor = 1.05, .tolerance = 1e-3});
  rule.stable_up_to_N_per_m = boundary.value > 0.0 ? boundary.value : stiffness_N_per_m;
  rule.kept = boundary.value > 0.0 && !boundary.crossed;
  const double inverse_mass = (rule.stable_up_to_N_per_m / stiffness_N_per_m - 1.0) / rigid.mass_kg - turning;
  rule.min_mass_kg = inverse_mass > 0.0 ? 1.0 / inverse_mass : std::numeric_limits<double>::infinity();
  return rule;
}

}  // namespace osteon::hil
