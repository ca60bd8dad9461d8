#include "control/setup/calibration.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <Eigen/Dense>

#include "kinematics/serial_chain.h"

namespace osteon::control {
namespace {

constexpr std::size_t kMinPoses = 4;
constexpr double kMinMass_kg = 1e-3;  // a smaller fitted payload is an error
// Smallest accepted spread of the poses. FitPayload compares it with the spread of gravity's direction,
// FitPivot with the ratio of the smallest to the largest singular value. With a smaller spread, noise of some
// percent would make the result meaningless. Rotations by ±20 deg about two axes give about 0.06 (payload)
// and 0.1 (pivot).
constexpr double kMinSpread = 0.05;

// Matrix of the cross product: Cross(v) u = v × u.
Matrix3 Cross(const Vector3& v) {
  Matrix3 M;
  M << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return M;
}

tl::unexpected<std::string> TooFew(std::size_t count) {
  return tl::unexpected(fmt::format("found {} poses at rest, accepted {} or more", count, kMinPoses));
}

}  // namespace

tl::expected<PayloadFit, std::string> FitPayload(std::span<const RestPose> poses) {
  if (poses.size() < kMinPoses) return TooFew(poses.size());
  const auto rows = static_cast<Eigen::Index>(3 * poses.size());
  // unknowns in the equations of the forces: m, b_f; in those of the torques: m c, b_t
  Eigen::MatrixXd A_f(rows, 4), A_t(rows, 6), directions(static_cast<Eigen::Index>(poses.size()), 3);
  Eigen::VectorXd f(rows), t(rows);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(3 * i);
    if (!poses[i].R_WS.allFinite() || !poses[i].F_S.f.allFinite() || !poses[i].F_S.t.allFinite())
      return tl::unexpected(fmt::format("pose {}: found values that are not finite", i + 1));
    const Vector3 g_S = poses[i].R_WS.transpose() * kinematics::kGravity_W_m_per_s2;
    directions.row(static_cast<Eigen::Index>(i)) = g_S.normalized().transpose();
    A_f.block<3, 1>(row, 0) = g_S;
    A_f.block<3, 3>(row, 1) = Matrix3::Identity();
    A_t.block<3, 3>(row, 0) = -Cross(g_S);
    A_t.block<3, 3>(row, 3) = Matrix3::Identity();
    f.segment<3>(row) = poses[i].F_S.f;
    t.segment<3>(row) = poses[i].F_S.t;
  }
  // The directions of gravity in S, relative to their mean, must vary in two dimensions.
  const Eigen::MatrixXd about_mean = directions.rowwise() - directions.colwise().mean();
  const Eigen::Vector3d spread =
      about_mean.jacobiSvd().singularValues() / std::sqrt(static_cast<double>(poses.size()));
  if (!(spread[1] >= kMinSpread))
    return tl::unexpected(
        fmt::format("the poses turn the sensor about one axis or not at all: the second spread of gravity's "
                    "direction is {:.3f}, accepted {} or more; tilt it by 20 deg or more about two axes",
                    spread[1], kMinSpread));

  const auto forces = A_f.colPivHouseholderQr();
  const Eigen::Vector4d x = forces.solve(f);
  PayloadFit fit;
  fit.mass_kg = x[0];
  fit.bias_S.f = x.tail<3>();
  if (!(fit.mass_kg >= kMinMass_kg))
    return tl::unexpected(
        fmt::format("found a mass of {:.4f} kg, accepted {} or more: is the reading's sign as the sensor's "
                    "file says, and does it carry anything?",
                    fit.mass_kg, kMinMass_kg));
  const Eigen::Matrix<double, 6, 1> y = A_t.colPivHouseholderQr().solve(t);
  fit.center_S_m = y.head<3>() / fit.mass_kg;
  fit.bias_S.t = y.tail<3>();

  // Compute the residuals, and from them the standard deviations of the unknowns.
  const auto count = static_cast<double>(rows);
  const double force_squares = (A_f * x - f).squaredNorm(), torque_squares = (A_t * y - t).squaredNorm();
  fit.residual_N = std::sqrt(force_squares / count);
  fit.residual_Nm = std::sqrt(torque_squares / count);
  const double force_variance = force_squares / std::max(1.0, count - 4.0),
               torque_variance = torque_squares / std::max(1.0, count - 6.0);
  const Eigen::Matrix4d inverse_normal_f = (A_f.transpose() * A_f).inverse();
  const Eigen::MatrixXd inverse_normal_t = (A_t.transpose() * A_t).inverse();
  fit.mass_sd_kg = std::sqrt(force_variance * inverse_normal_f(0, 0));
  fit.center_sd_m =
      std::sqrt(torque_variance * inverse_normal_t.topLeftCorner<3, 3>().diagonal().maxCoeff()) / fit.mass_kg;
  return fit;
}

tl::expected<PivotFit, std::string> FitPivot(std::span<const Pose> X_WF) {
  if (X_WF.size() < kMinPoses) return TooFew(X_WF.size());
  const auto rows = static_cast<Eigen::Index>(3 * X_WF.size());
  Eigen::MatrixXd A(rows, 6);
  Eigen::VectorXd p(rows);
  for (std::size_t i = 0; i < X_WF.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(3 * i);
    if (!X_WF[i].matrix().allFinite())
      return tl::unexpected(fmt::format("pose {}: found values that are not finite", i + 1));
    // R_i p_FT - p_WT = -p_i
    A.block<3, 3>(row, 0) = X_WF[i].linear();
    A.block<3, 3>(row, 3) = -Matrix3::Identity();
    p.segment<3>(row) = -X_WF[i].translation();
  }
  // If the poses turn too little, a displacement of the tip cannot be distinguished from one of the fixed
  // point.
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const double spread = svd.singularValues()[5] / svd.singularValues()[0];
  if (!(spread >= kMinSpread))
    return tl::unexpected(fmt::format(
        "the poses turn the tool too little: their least spread is {:.3f}, accepted {} or more; turn "
        "it by 20 deg or more about two axes with its tip on the point",
        spread, kMinSpread));
  const Eigen::Matrix<double, 6, 1> x = svd.solve(p);
  PivotFit fit;
  fit.p_FT_m = x.head<3>();
  fit.p_WT_m = x.tail<3>();
  double squares = 0.0;
  for (const Pose& X : X_WF) {
    const double distance_m = (X * fit.p_FT_m - fit.p_WT_m).norm();
    squares += distance_m * distance_m;
    fit.worst_m = std::max(fit.worst_m, distance_m);
  }
  fit.residual_m = std::sqrt(squares / static_cast<double>(X_WF.size()));
  const double variance = squares / std::max(1.0, static_cast<double>(rows) - 6.0);
  const Eigen::MatrixXd covariance = variance * (A.transpose() * A).inverse();
  fit.sd_m = std::sqrt(covariance.topLeftCorner<3, 3>().jacobiSvd().singularValues()[0]);
  return fit;
}

}  // namespace osteon::control
