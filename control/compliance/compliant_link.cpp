#include "control/compliance/compliant_link.h"

#include <stdexcept>

#include <Eigen/Eigenvalues>

#include "base/parameter_check.h"

namespace osteon::control {

Pose BentHead(const Vector6& e) OSTEON_RT {
  Pose X_TE = Pose::Identity();
  X_TE.linear() = ExpRotation(e.tail<3>());
  X_TE.translation() = e.head<3>();
  return X_TE;
}

void Validate(const ToolLinkParams& params) {
  const base::ParameterCheck require("compliance tool ");
  require("tau_s", params.tau_s, 1e-3, 10.0);
  require("max_bend_m", params.max_bend_m, 1e-5, 0.1);
  require("max_thrust_N", params.max_thrust_N, 0.1, 1e7);
  const Matrix6& C = params.compliance_T;
  if (!C.allFinite() || !C.isApprox(C.transpose(), 1e-9))
    throw std::invalid_argument("compliance tool: accepted a finite symmetric matrix");
  const double min_eigenvalue = Eigen::SelfAdjointEigenSolver<Matrix6>(C).eigenvalues().minCoeff();
  if (!(min_eigenvalue >= -1e-12 * C.cwiseAbs().maxCoeff()))
    throw std::invalid_argument("compliance tool: found a matrix that yields energy, accepted none");
}

}  // namespace osteon::control
