#include "procedure/assessment/sphere_fit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "base/percentile.h"
#include "base/units.h"

namespace osteon::procedure {
namespace {

constexpr std::size_t kMinBalls = 30;  // no sphere is fitted to fewer cut balls
constexpr int kMaxSteps = 50;
constexpr double kConverged_m = 1e-9;  // the fit ends at a step that changes centre and radius by less

// Returns the balls whose point nearest to the centre is below the plane through the centre perpendicular to
// the axis.
std::vector<simulation::Ball> BelowCentre(std::span<const simulation::Ball> balls, const Vector3& axis,
                                          const Vector3& centre_m) {
  std::vector<simulation::Ball> below;
  for (const simulation::Ball& ball : balls)
    if ((Vector3(ball.center_m) - centre_m).dot(axis) < 0.0) below.push_back(ball);
  return below;
}

// Makes one Gauss-Newton step on the residuals |c_i - C| - r_i - R.
// @returns length of the change of centre and radius [m]
double GaussNewtonStep(std::span<const simulation::Ball> balls, Vector3& centre_m, double& radius_m) {
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  Eigen::Vector4d b = Eigen::Vector4d::Zero();
  for (const simulation::Ball& ball : balls) {
    const Vector3 way_m = Vector3(ball.center_m) - centre_m;
    const double length_m = way_m.norm();
    if (length_m <= 0.0) continue;
    Eigen::Vector4d gradient;  // gradient of one residual with respect to centre and radius
    gradient << -way_m / length_m, -1.0;
    A += gradient * gradient.transpose();
    b -= gradient * (length_m - ball.radius_m - radius_m);
  }
  const Eigen::Vector4d step = A.ldlt().solve(b);
  centre_m += step.head<3>();
  radius_m += step(3);
  return step.norm();
}

}  // namespace

tl::expected<SphereFit, std::string> FitSphere(std::span<const simulation::Ball> cut_balls,
                                               const Vector3& axis, const Vector3& near_centre_m,
                                               double near_radius_m) {
  SphereFit fit{.centre_m = near_centre_m, .radius_m = near_radius_m};
  std::vector<simulation::Ball> balls;
  double moved_m = 0.0;
  for (int i = 0; i < kMaxSteps; ++i) {
    balls = BelowCentre(cut_balls, axis, fit.centre_m);
    if (balls.size() < kMinBalls)
      return tl::make_unexpected(
          fmt::format("found {} cut balls below the centre, accepted at least {}", balls.size(), kMinBalls));
    moved_m = GaussNewtonStep(balls, fit.centre_m, fit.radius_m);
    if (!(moved_m > kConverged_m)) break;
  }
  // if the last step was longer than 1 µm, the fit has not converged
  if (!(moved_m <= 1e-6) || !(fit.radius_m > 0.0) || !fit.centre_m.allFinite())
    return tl::make_unexpected("found a cavity that no sphere fits, accepted one that a reamer left");

  std::vector<double> residuals_m;
  double squares = 0.0;
  for (const simulation::Ball& ball : balls) {
    const Vector3 way_m = Vector3(ball.center_m) - fit.centre_m;
    const double length_m = way_m.norm();
    const double residual_m = length_m - ball.radius_m - fit.radius_m;
    squares += residual_m * residual_m;
    residuals_m.push_back(std::abs(residual_m));
    fit.cap_rad = std::max(fit.cap_rad, std::acos(std::clamp(-way_m.dot(axis) / length_m, -1.0, 1.0)));
  }
  if (fit.cap_rad < kMinCap_rad)
    return tl::make_unexpected(fmt::format("found a cap of {:.1f}°, accepted at least {:g}°",
                                           fit.cap_rad / kDegree, kMinCap_rad / kDegree));
  const auto n = static_cast<double>(balls.size());
  fit.balls = balls.size();
  fit.residual_p95_m = base::LowerPercentile(residuals_m, 0.95);
  fit.residual_sd_m = std::sqrt(squares / n);
  // standard deviations by the formulas in the header
  const double c = std::cos(fit.cap_rad), scale_m = fit.residual_sd_m / std::sqrt(n);
  const double lever = (1.0 + c) / (1.0 - c);
  fit.radius_sd_m = scale_m * std::sqrt(1.0 + 3.0 * lever * lever);
  fit.depth_sd_m = scale_m * std::sqrt(12.0) / (1.0 - c);
  return fit;
}

}  // namespace osteon::procedure
