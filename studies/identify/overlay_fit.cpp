#include "studies/identify/overlay_fit.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <fmt/format.h>

#include "studies/identify/response_fit.h"

namespace osteon::studies {
namespace {

constexpr double kHalfWidthSd = 2.0, kMaxOverlayChi2 = 3.0, kTurn = 2.0 * std::numbers::pi;
constexpr std::size_t kMinLines = 6;
// log mass, log damping, log stiffness, dead time; with a coupled axis log w and log damping ratio of two
// zeros, then of two poles
constexpr int kAlone = 4, kCoupled = 8;

// Zeros over poles of the axis that is coupled: 1 at rest.
std::complex<double> CoupledAxis(const Eigen::VectorXd& p, double w) {
  if (p.size() < kCoupled) return 1.0;
  const auto pair = [w](double log_w, double log_damping) {
    const double ratio = w / std::exp(log_w);
    return std::complex<double>(1.0 - ratio * ratio, 2.0 * std::exp(log_damping) * ratio);
  };
  return pair(p[4], p[5]) / pair(p[6], p[7]);
}

std::complex<double> OverlayResponse(const Eigen::VectorXd& p, double hz, double period_s,
                                     double nominal_N_per_m) {
  const double mass_kg = std::exp(p[0]), stiffness = std::exp(p[2]), w = std::sqrt(stiffness / mass_kg);
  const ServoModel model{.bandwidth_hz = w / kTurn,
                         .damping_ratio = std::exp(p[1]) / (2.0 * mass_kg * w),
                         .dead_time_s = p[3],
                         .gain = nominal_N_per_m / stiffness};
  return SampledResponse(model, period_s, hz) * CoupledAxis(p, kTurn * hz);
}

LeastSquaresFit FitLines(std::span<const ResponseLine> lines, const Eigen::VectorXd& start, double period_s,
                         double nominal_N_per_m) {
  return FitResponse(
      lines,
      [&](const Eigen::VectorXd& p, double hz) { return OverlayResponse(p, hz, period_s, nominal_N_per_m); },
      start);
}

// The same with a coupled axis, from several frequencies of it.
LeastSquaresFit FitCoupled(std::span<const ResponseLine> lines, const Eigen::VectorXd& alone, double period_s,
                           double nominal_N_per_m) {
  LeastSquaresFit best;
  for (const double hz : {4.0, 7.0, 11.0, 16.0, 24.0})
    for (const double ratio : {0.8, 0.95, 1.1}) {
      Eigen::VectorXd start(kCoupled);
      start << alone, std::log(kTurn * hz * ratio), std::log(0.5), std::log(kTurn * hz), std::log(0.5);
      const LeastSquaresFit fit = FitLines(lines, start, period_s, nominal_N_per_m);
      if (fit.converged && (!best.converged || fit.cost < best.cost)) best = fit;
    }
  return best;
}

OverlayFit ResultOf(const LeastSquaresFit& fit, double chi2) {
  const Eigen::VectorXd& p = fit.parameters;
  const bool coupled = p.size() == kCoupled;
  // far above the springs the coupled axis gives way as well
  const double mass_kg = std::exp(p[0] + (coupled ? 2.0 * (p[4] - p[6]) : 0.0)), damping = std::exp(p[1]),
               stiffness = std::exp(p[2]);
  const Eigen::MatrixXd covariance = std::max(1.0, chi2) * fit.covariance;
  // half width of a sum of parameters, by its weights: log mass, log damping, log stiffness, dead time
  const auto width = [&](double of_mass, double of_damping, double of_stiffness, double of_dead) {
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(p.size());
    gradient.head<4>() << of_mass, of_damping, of_stiffness, of_dead;
    if (coupled) {
      gradient[4] = 2.0 * of_mass;
      gradient[6] = -2.0 * of_mass;
    }
    return kHalfWidthSd * std::sqrt(std::max(0.0, gradient.dot(covariance * gradient)));
  };
  const double hz = std::sqrt(stiffness / mass_kg) / kTurn,
               ratio = damping / (2.0 * std::sqrt(stiffness * mass_kg)), viscous_s = damping / stiffness;
  return {.stiffness_N_per_m = {stiffness, stiffness * width(0.0, 0.0, 1.0, 0.0)},
          .damping_Ns_per_m = {damping, damping * width(0.0, 1.0, 0.0, 0.0)},
          .mass_kg = {mass_kg, mass_kg * width(1.0, 0.0, 0.0, 0.0)},
          .dead_time_s = {p[3], width(0.0, 0.0, 0.0, 1.0)},
          .bandwidth_hz = {hz, hz * width(-0.5, 0.0, 0.5, 0.0)},
          .damping_ratio = {ratio, ratio * width(-0.5, 1.0, -0.5, 0.0)},
          .lag_s = {p[3] + viscous_s, width(0.0, viscous_s, -viscous_s, 1.0)},
          .chi2 = chi2,
          .coupled = coupled};
}

}  // namespace

tl::expected<OverlayFit, std::string> FitOverlay(std::span<const ResponseLine> lines, const ServoFit& start,
                                                 double period_s, double nominal_N_per_m) {
  if (lines.size() < kMinLines)
    return tl::unexpected(fmt::format("found {} lines, accepted {} or more", lines.size(), kMinLines));
  // spring by the lowest line, mass by the highest; then as an arm was fitted
  const double w_high = kTurn * lines.back().hz, stiffness = nominal_N_per_m / std::abs(lines.front().value),
               mass_kg = nominal_N_per_m / (std::abs(lines.back().value) * w_high * w_high);
  Eigen::VectorXd guess(kAlone);
  guess << std::log(mass_kg), std::log(1.4 * std::sqrt(stiffness * mass_kg)), std::log(stiffness),
      std::clamp(start.dead_time_s.value, 0.0, 0.02);
  LeastSquaresFit fit = FitLines(lines, guess, period_s, nominal_N_per_m);
  if (!fit.converged || Chi2Of(fit, lines.size()) > kMaxOverlayChi2) {
    guess[3] = 0.003;
    const LeastSquaresFit coupled =
        FitCoupled(lines, fit.converged ? fit.parameters : guess, period_s, nominal_N_per_m);
    if (coupled.converged && (!fit.converged || coupled.cost < fit.cost)) fit = coupled;
  }
  if (!fit.converged) return tl::unexpected(std::string("no impedance fits the motion: no start converged"));
  OverlayFit overlay = ResultOf(fit, Chi2Of(fit, lines.size()));
  double squares = 0.0;
  for (const ResponseLine& line : lines)
    squares += std::norm((line.value - OverlayResponse(fit.parameters, line.hz, period_s, nominal_N_per_m)) /
                         line.value);
  overlay.residual = std::sqrt(squares / static_cast<double>(lines.size()));
  return overlay;
}

MeasuredResponse PerForce(MeasuredResponse response, double nominal_N_per_m) {
  for (ResponseLine& line : response.lines) {
    line.value /= nominal_N_per_m;
    line.noise_sd /= nominal_N_per_m;
    line.sd /= nominal_N_per_m;
  }
  return response;
}

}  // namespace osteon::studies
