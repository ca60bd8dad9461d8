#include "studies/identify/servo_response.h"

#include <cmath>
#include <numbers>

#include <Eigen/Core>
#include <Eigen/LU>

namespace osteon::app {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

// Transition of (y - target, y') over a time: the closed form of e'' = -w^2 e - 2 z w e'.
Eigen::Matrix2d Transition(double w, double z, double time_s) {
  const double a = z * w, s2 = a * a - w * w, s = std::sqrt(std::abs(s2));
  double C = 1.0, S = time_s;  // the limit at z = 1
  if (s * time_s > 1e-9) {
    C = s2 > 0.0 ? std::cosh(s * time_s) : std::cos(s * time_s);
    S = (s2 > 0.0 ? std::sinh(s * time_s) : std::sin(s * time_s)) / s;
  }
  Eigen::Matrix2d E;
  E << C + a * S, S, -w * w * S, C - a * S;
  return std::exp(-a * time_s) * E;
}

}  // namespace

double ServoModel::lag_s() const { return dead_time_s + 2.0 * damping_ratio / (kTurn * bandwidth_hz); }

std::complex<double> SampledResponse(const ServoModel& model, double period_s, double hz) {
  const double w = kTurn * model.bandwidth_hz, z = model.damping_ratio;
  const double periods = std::floor(model.dead_time_s / period_s);
  const double rest_s = model.dead_time_s - periods * period_s;
  const Eigen::Matrix2d unit = Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d late = Transition(w, z, period_s - rest_s);
  const Eigen::Vector2d c(model.gain, 0.0);
  const Eigen::Vector2d from_old = late * (unit - Transition(w, z, rest_s)) * c, from_new = (unit - late) * c;
  const std::complex<double> q = std::polar(1.0, kTurn * hz * period_s);
  const Eigen::Matrix2cd resolvent =
      (q * unit.cast<std::complex<double>>() - Transition(w, z, period_s).cast<std::complex<double>>())
          .inverse();
  const Eigen::Vector2cd driven =
      from_old.cast<std::complex<double>>() / q + from_new.cast<std::complex<double>>();
  return (resolvent * driven)[0] * std::polar(1.0, -kTurn * hz * periods * period_s);
}

}  // namespace osteon::app
