#include "studies/identify/servo_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "studies/identify/least_squares.h"

namespace osteon::studies {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr int kParameters = 4;
constexpr double kIntervalSd = 2.0;  // half width of a 95 % interval, in standard deviations
// A smaller residual is only rounding: the fit of a simulated arm without noise ends at the search's
// tolerance.
constexpr double kRounding = 1e-8;

// The model with the fitted parameters p = (log of the bandwidth [Hz], log of the damping ratio, dead time
// [s], gain).
ServoModel ModelOf(const Eigen::VectorXd& p) {
  return {.bandwidth_hz = std::exp(p[0]), .damping_ratio = std::exp(p[1]), .dead_time_s = p[2], .gain = p[3]};
}

// Delay [s] by the phase at the third lowest line; start value of the fit.
double LagOf(std::span<const ResponseLine> lines) {
  const ResponseLine& line = lines[std::min<std::size_t>(2, lines.size() - 1)];
  return -std::arg(line.value) / (kTurn * line.hz);
}

}  // namespace

tl::expected<ServoFit, std::string> FitServo(std::span<const ResponseLine> lines, double period_s) {
  if (lines.size() < kParameters)
    return tl::unexpected(fmt::format("found {} lines, accepted {} or more", lines.size(), kParameters));
  const auto residuals = [&](const Eigen::VectorXd& p, Eigen::VectorXd& r) {
    const ServoModel model = ModelOf(p);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::complex<double> residual =
          (lines[i].value - SampledResponse(model, period_s, lines[i].hz)) / lines[i].sd;
      r[2 * static_cast<Eigen::Index>(i)] = residual.real();
      r[2 * static_cast<Eigen::Index>(i) + 1] = residual.imag();
    }
  };
  const LeastSquares problem{
      .parameters = kParameters, .residuals = 2 * static_cast<int>(lines.size()), .evaluate = residuals};
  const double lag_s = LagOf(lines);
  LeastSquaresFit best;
  // The cost has several minima: start from each of these bandwidths, with the dead time that gives the
  // measured lag.
  for (const double hz : {6.0, 12.0, 25.0, 50.0}) {
    const double dead_s = lag_s - 2.0 / (kTurn * hz);
    const LeastSquaresFit fit = Solve(problem, Eigen::Vector4d(std::log(hz), 0.0, dead_s, 1.0));
    if (fit.converged && (!best.converged || fit.cost < best.cost)) best = fit;
  }
  if (!best.converged) return tl::unexpected(std::string("no second-order model fits: no start converged"));

  ServoFit fit{.model = ModelOf(best.parameters)};
  const double degrees_of_freedom = 2.0 * static_cast<double>(lines.size()) - kParameters;
  double squares = 0.0;
  for (const ResponseLine& line : lines)
    squares += std::norm(line.value - SampledResponse(fit.model, period_s, line.hz));
  fit.residual = std::sqrt(squares / static_cast<double>(lines.size()));
  fit.chi2 = best.cost / degrees_of_freedom;
  if (fit.residual <= kRounding) fit.chi2 = std::min(fit.chi2, 1.0);
  const Eigen::MatrixXd covariance = std::max(1.0, fit.chi2) * best.covariance;
  // half width of a value's interval, from the value's gradient by the parameters
  const auto width = [&](const Eigen::Vector4d& gradient) {
    return kIntervalSd * std::sqrt(std::max(0.0, gradient.dot(covariance * gradient)));
  };
  const ServoModel& m = fit.model;
  const double second_order_lag_s = 2.0 * m.damping_ratio / (kTurn * m.bandwidth_hz);
  fit.bandwidth_hz = {m.bandwidth_hz, width({m.bandwidth_hz, 0.0, 0.0, 0.0})};
  fit.damping_ratio = {m.damping_ratio, width({0.0, m.damping_ratio, 0.0, 0.0})};
  fit.dead_time_s = {m.dead_time_s, width({0.0, 0.0, 1.0, 0.0})};
  fit.gain = {m.gain, width({0.0, 0.0, 0.0, 1.0})};
  fit.lag_s = {m.lag_s(), width({-second_order_lag_s, second_order_lag_s, 1.0, 0.0})};
  return fit;
}

double ValidationChi2(const ServoModel& model, std::span<const ResponseLine> lines, double period_s) {
  double chi2 = 0.0;
  for (const ResponseLine& line : lines)
    chi2 += std::norm(line.value - SampledResponse(model, period_s, line.hz)) / (line.sd * line.sd);
  return chi2 / (2.0 * static_cast<double>(lines.size()));
}

}  // namespace osteon::studies
