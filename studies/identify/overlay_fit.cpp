#include "studies/identify/overlay_fit.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "studies/identify/least_squares.h"

namespace osteon::app {
namespace {

constexpr double kHalfWidthSd = 2.0, kMaxOverlayChi2 = 3.0, kHigh_hz = 15.0, kTurn = 2.0 * std::numbers::pi;
constexpr std::size_t kLowLines = 2, kMinLines = 6;
constexpr int kParameters = 4;  // log mass, log damping, log stiffness, dead time

ServoModel ImpedanceModel(const Eigen::VectorXd& p, double nominal_N_per_m) {
  const double mass_kg = std::exp(p[0]), damping = std::exp(p[1]), stiffness = std::exp(p[2]);
  const double w = std::sqrt(stiffness / mass_kg);
  return {.bandwidth_hz = w / kTurn,
          .damping_ratio = damping / (2.0 * mass_kg * w),
          .dead_time_s = p[3],
          .gain = nominal_N_per_m / stiffness};
}

LeastSquaresFit FitLines(std::span<const ResponseLine> lines, const Eigen::VectorXd& start, double period_s,
                         double nominal_N_per_m) {
  const auto residuals = [&](const Eigen::VectorXd& p, Eigen::VectorXd& r) {
    const ServoModel model = ImpedanceModel(p, nominal_N_per_m);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::complex<double> off =
          (lines[i].value - SampledResponse(model, period_s, lines[i].hz)) / lines[i].sd;
      r[2 * static_cast<Eigen::Index>(i)] = off.real();
      r[2 * static_cast<Eigen::Index>(i) + 1] = off.imag();
    }
  };
  return Solve(
      {.parameters = kParameters, .residuals = 2 * static_cast<int>(lines.size()), .evaluate = residuals},
      start);
}

double OverlayChi2(const LeastSquaresFit& fit, std::size_t lines) {
  return fit.cost / (2.0 * static_cast<double>(lines) - kParameters);
}

// The lines that decide mass, dead time and spring, without those around the springs' frequencies.
std::vector<ResponseLine> Ends(std::span<const ResponseLine> lines) {
  std::vector<ResponseLine> ends;
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (i < kLowLines || lines[i].hz >= kHigh_hz) ends.push_back(lines[i]);
  return ends;
}

OverlayFit ResultOf(const LeastSquaresFit& fit, double chi2) {
  const Eigen::VectorXd& p = fit.parameters;
  const double mass_kg = std::exp(p[0]), damping = std::exp(p[1]), stiffness = std::exp(p[2]);
  const Eigen::MatrixXd covariance = std::max(1.0, chi2) * fit.covariance;
  // half width by the gradient over the parameters
  const auto width = [&](const Eigen::Vector4d& gradient) {
    return kHalfWidthSd * std::sqrt(std::max(0.0, gradient.dot(covariance * gradient)));
  };
  const double hz = std::sqrt(stiffness / mass_kg) / kTurn,
               ratio = damping / (2.0 * std::sqrt(stiffness * mass_kg)), viscous_s = damping / stiffness;
  return {.stiffness_N_per_m = {stiffness, width({0.0, 0.0, stiffness, 0.0})},
          .damping_Ns_per_m = {damping, width({0.0, damping, 0.0, 0.0})},
          .mass_kg = {mass_kg, width({mass_kg, 0.0, 0.0, 0.0})},
          .dead_time_s = {p[3], width({0.0, 0.0, 0.0, 1.0})},
          .bandwidth_hz = {hz, width({-0.5 * hz, 0.0, 0.5 * hz, 0.0})},
          .damping_ratio = {ratio, width({-0.5 * ratio, ratio, -0.5 * ratio, 0.0})},
          .lag_s = {p[3] + viscous_s, width({0.0, viscous_s, -viscous_s, 1.0})},
          .chi2 = chi2};
}

}  // namespace

tl::expected<OverlayFit, std::string> FitOverlay(std::span<const ResponseLine> lines, const ServoFit& start,
                                                 double period_s, double nominal_N_per_m) {
  if (lines.size() < kMinLines)
    return tl::unexpected(fmt::format("found {} lines, accepted {} or more", lines.size(), kMinLines));
  // spring by the lowest line, mass by the highest; then as an arm was fitted
  const double w_high = kTurn * lines.back().hz, stiffness = nominal_N_per_m / std::abs(lines.front().value),
               mass_kg = nominal_N_per_m / (std::abs(lines.back().value) * w_high * w_high);
  Eigen::VectorXd guess(kParameters);
  guess << std::log(mass_kg), std::log(1.4 * std::sqrt(stiffness * mass_kg)), std::log(stiffness),
      std::clamp(start.dead_time_s.value, 0.0, 0.02);
  std::vector<ResponseLine> used(lines.begin(), lines.end());
  LeastSquaresFit fit = FitLines(used, guess, period_s, nominal_N_per_m);
  const bool ends_only = !fit.converged || OverlayChi2(fit, used.size()) > kMaxOverlayChi2;
  if (ends_only) {
    used = Ends(lines);
    if (used.size() < kMinLines)
      return tl::unexpected(
          fmt::format("found {} lines up to 15 Hz alone, accepted higher ones", lines.size()));
    fit = FitLines(used, guess, period_s, nominal_N_per_m);
  }
  if (!fit.converged) return tl::unexpected(std::string("no impedance fits the motion: no start converged"));
  OverlayFit overlay = ResultOf(fit, OverlayChi2(fit, used.size()));
  overlay.ends_only = ends_only;
  const ServoModel model = ImpedanceModel(fit.parameters, nominal_N_per_m);
  double squares = 0.0;
  for (const ResponseLine& line : used)
    squares += std::norm((line.value - SampledResponse(model, period_s, line.hz)) / line.value);
  overlay.residual = std::sqrt(squares / static_cast<double>(used.size()));
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

}  // namespace osteon::app
