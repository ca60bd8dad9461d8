#include "studies/stability/age_bound.h"

namespace osteon::hil {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

double AgeReserve(const Matrix6& D, const Matrix6& K, double max_age_s) {
  return Eigen::SelfAdjointEigenSolver<Matrix6>(D - max_age_s * K, Eigen::EigenvaluesOnly).eigenvalues()[0];
}

double LeverStiffness(double lever_m, double damping_Ns_per_m, double damping_Nms_per_rad, double max_age_s) {
  return 1.0 / (max_age_s * (1.0 / damping_Ns_per_m + lever_m * lever_m / damping_Nms_per_rad));
}

}  // namespace osteon::hil
