#include "studies/identify/servo_response.h"

#include <cmath>
#include <numbers>

#include <Eigen/Core>
#include <Eigen/LU>

#include "hil/arm/second_order_step.h"

namespace osteon::studies {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

}  // namespace

double ServoModel::lag_s() const { return dead_time_s + 2.0 * damping_ratio / (kTurn * bandwidth_hz); }

std::complex<double> SampledResponse(const ServoModel& model, double period_s, double hz) {
  const double w = kTurn * model.bandwidth_hz, z = model.damping_ratio;
  // n and r of SampledResponse; then the factors of u[k-n-1] and u[k-n]
  const double periods = std::floor(model.dead_time_s / period_s);
  const double rest_s = model.dead_time_s - periods * period_s;
  const Eigen::Matrix2d unit = Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d late = hil::SecondOrderStep(w, z, period_s - rest_s);
  const Eigen::Vector2d c(model.gain, 0.0);
  const Eigen::Vector2d from_old = late * (unit - hil::SecondOrderStep(w, z, rest_s)) * c,
                        from_new = (unit - late) * c;
  // z-transform: x = (q 1 - E(T))^-1 (from_old / q + from_new) q^-n u with q = exp(i w T)
  const std::complex<double> q = std::polar(1.0, kTurn * hz * period_s);
  const Eigen::Matrix2cd resolvent = (q * unit.cast<std::complex<double>>() -
                                      hil::SecondOrderStep(w, z, period_s).cast<std::complex<double>>())
                                         .inverse();
  const Eigen::Vector2cd driven =
      from_old.cast<std::complex<double>>() / q + from_new.cast<std::complex<double>>();
  return (resolvent * driven)[0] * std::polar(1.0, -kTurn * hz * periods * period_s);
}

}  // namespace osteon::studies
