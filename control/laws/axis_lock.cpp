#include "control/laws/axis_lock.h"

#include <algorithm>

namespace osteon::control {
namespace {

constexpr double kReturn_s = 0.010;                           // time constant of the return to a locked axis
constexpr double kMax_m_per_s = 0.020, kMax_rad_per_s = 0.1;  // largest speed of that return

// Shortens a vector to at most max_norm.
Vector3 Within(const Vector3& v, double max_norm) {
  const double size = v.norm();
  return size > max_norm ? Vector3(max_norm / size * v) : v;
}

}  // namespace

AxisLock::AxisLock(const AdmittanceParams& params, double period_s)
    : centre_T_m_(params.centre_T_m),
      // if the period is longer than kReturn_s, the deviation is removed in one tick, without overshoot
      return_s_(std::max(kReturn_s, period_s)),
      any_(std::any_of(params.locked.begin(), params.locked.end(), [](bool locked) { return locked; })) {
  for (int i = 0; i < 3; ++i) {
    position_[i] = params.locked[static_cast<std::size_t>(i)] ? 1.0 : 0.0;
    turn_[i] = params.locked[static_cast<std::size_t>(i) + 3] ? 1.0 : 0.0;
  }
}

void AxisLock::Reset(const Pose& X_WT) OSTEON_RT { X_WC_ = X_WT * Eigen::Translation3d(centre_T_m_); }

Twist AxisLock::Correction(const Pose& X_WT) OSTEON_RT {
  if (!any_) return {};
  const Pose X_WC = X_WT * Eigen::Translation3d(centre_T_m_);

  // The reference stands still on locked axes and follows the tool on free axes. turn_C and to_reference_W
  // are rotation and displacement from the tool to the reference.
  const Vector3 turn_C = turn_.cwiseProduct(LogRotation(X_WC.linear().transpose() * X_WC_.linear()));
  if (!turn_.isOnes(0.0)) X_WC_.linear() = X_WC.linear() * ExpRotation(turn_C);
  const Matrix3 R_W = X_WC_.linear();
  const Vector3 to_reference_W =
      R_W * position_.cwiseProduct(R_W.transpose() * (X_WC_.translation() - X_WC.translation()));
  X_WC_.translation() = X_WC.translation() + to_reference_W;

  return {.v = position_.cwiseProduct(
              Within(X_WC.linear().transpose() * to_reference_W / return_s_, kMax_m_per_s)),
          .w = Within(turn_C / return_s_, kMax_rad_per_s)};
}

}  // namespace osteon::control
