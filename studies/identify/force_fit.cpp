#include "studies/identify/force_fit.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "studies/identify/response_fit.h"

namespace osteon::studies {
namespace {

using Complex = std::complex<double>;

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kTwoSd = 2.0;  // half width of a 95 % interval, in standard deviations
// A resonance is tried if chi² without it is above kBadChi2. It is kept if chi² falls by more than the factor
// kResonanceGain.
constexpr double kResonanceGain = 3.0, kBadChi2 = 3.0;
// A grip time is tried if chi² without it is above kExactChi2. It is kept if chi² falls by more than the
// factor kGripGain.
constexpr double kExactChi2 = 0.1, kGripGain = 2.0;
// Highest resonance, as a factor on the highest line: nothing was measured beyond.
constexpr double kMaxResonance = 1.5;

// Half width of the 95 % interval of parameter i; a chi² above 1 widens it. @param factor  converts the
// interval of a logarithm to that of its value
double Width(const LeastSquaresFit& fit, double chi2, Eigen::Index i, double factor = 1.0) {
  return kTwoSd * factor * std::sqrt(std::max(1.0, chi2) * std::max(0.0, fit.covariance(i, i)));
}

// Force over position of a mass p[0] [kg] behind a delay p[1] [s], at one frequency.
Complex Inertia(const Eigen::VectorXd& p, double hz) {
  const double w = kTwoPi * hz;
  return p[0] * w * w * std::polar(1.0, -w * p[1]);
}

// R(w) of FitToolForce: the tool's motion divided by the encoders' motion, at one frequency.
Complex Resonance(double resonance_hz, double damping, double hz) {
  const double w_r = kTwoPi * resonance_hz, w = kTwoPi * hz;
  return w_r * w_r / Complex(w_r * w_r - w * w, 2.0 * damping * w_r * w);
}

// Fits mass, delay and a resonance. The fit starts from each of several frequencies, as the cost has several
// minima. The parameters are p = (mass, delay, log of the resonance in Hz, log of its damping ratio).
// @param rigid  mass and delay that were fitted without a resonance
LeastSquaresFit FitResonance(std::span<const ResponseLine> lines, const Eigen::VectorXd& rigid) {
  LeastSquaresFit best;
  const auto model = [](const Eigen::VectorXd& p, double hz) {
    return Inertia(p, hz) * Resonance(std::exp(p[2]), std::exp(p[3]), hz);
  };
  for (const double hz : {12.0, 18.0, 24.0, 30.0, 36.0, 45.0, 60.0, 80.0}) {
    const Eigen::Vector4d start(rigid[0], rigid[1], std::log(hz), std::log(0.05));
    const LeastSquaresFit fit = FitResponse(lines, model, start);
    if (fit.converged && (!best.converged || fit.cost < best.cost)) best = fit;
  }
  return best;
}

}  // namespace

tl::expected<ToolForceFit, std::string> FitToolForce(std::span<const ResponseLine> lines) {
  if (lines.size() < 4)
    return tl::unexpected(fmt::format("found {} lines, accepted 4 or more", lines.size()));
  // start the fit with the weighted mean of F / (x w^2)
  double weighted_sum = 0.0, weights = 0.0;
  for (const ResponseLine& line : lines) {
    const double w2 = kTwoPi * line.hz * kTwoPi * line.hz, weight = w2 * w2 / (line.sd * line.sd);
    weighted_sum += weight * (line.value / w2).real();
    weights += weight;
  }
  const LeastSquaresFit rigid = FitResponse(lines, Inertia, Eigen::Vector2d(weighted_sum / weights, 0.0));
  if (!rigid.converged) return tl::unexpected(std::string("no mass fits the force"));
  const double chi2 = Chi2Of(rigid, lines.size());
  ToolForceFit fit{.mass_kg = {rigid.parameters[0], Width(rigid, chi2, 0)},
                   .delay_s = {rigid.parameters[1], Width(rigid, chi2, 1)},
                   .resonance = {},
                   .chi2 = chi2};
  if (chi2 > kBadChi2)
    if (const LeastSquaresFit with_resonance = FitResonance(lines, rigid.parameters);
        with_resonance.converged) {
      const double chi2_with_resonance = Chi2Of(with_resonance, lines.size());
      const double hz = std::exp(with_resonance.parameters[2]),
                   damping = std::exp(with_resonance.parameters[3]);
      if (chi2_with_resonance * kResonanceGain < chi2 && hz <= kMaxResonance * lines.back().hz) {
        fit = {.mass_kg = {with_resonance.parameters[0], Width(with_resonance, chi2_with_resonance, 0)},
               .delay_s = {with_resonance.parameters[1], Width(with_resonance, chi2_with_resonance, 1)},
               .resonance = ResonanceFit{.hz = {hz, Width(with_resonance, chi2_with_resonance, 2, hz)},
                                         .damping_ratio = {damping, Width(with_resonance, chi2_with_resonance,
                                                                          3, damping)}},
               .chi2 = chi2_with_resonance};
      }
    }
  // the half width is two standard deviations, so this is a bound of three
  if (!(fit.mass_kg.value > 1.5 * fit.mass_kg.half_width))
    return tl::unexpected(
        fmt::format("the force sensor shows no inertia of the tool: found {:.3f} ± {:.3f} kg",
                    std::max(0.0, fit.mass_kg.value), fit.mass_kg.half_width));
  return fit;
}

namespace {

// Force over position of a tool held by a hand (FitHand's formula), at one frequency. The parameters are k,
// b, m, then grip time and delay if they are fitted, in this order.
struct HandModel {
  double tool_mass_kg{0.0};
  bool has_grip{false};
  std::optional<double> delay_s;  // none: the delay is fitted

  [[nodiscard]] Eigen::Index parameters() const { return 3 + (has_grip ? 1 : 0) + (delay_s ? 0 : 1); }
  [[nodiscard]] double Grip_s(const Eigen::VectorXd& p) const { return has_grip ? p[3] : 0.0; }
  [[nodiscard]] double Delay_s(const Eigen::VectorXd& p) const {
    return delay_s ? *delay_s : p[parameters() - 1];
  }
  Complex operator()(const Eigen::VectorXd& p, double hz) const {
    const double w = kTwoPi * hz;
    const Complex hand = Complex(p[0], w * p[1]) - w * w * p[2] / Complex(1.0, w * Grip_s(p));
    return (tool_mass_kg * w * w - hand) * std::polar(1.0, -w * Delay_s(p));
  }
};

// Fits the model, starting from each of several stiffnesses, as the cost has several minima. Returns the best
// fit.
LeastSquaresFit FitHandModel(std::span<const ResponseLine> lines, const HandModel& model) {
  LeastSquaresFit best;
  for (const double k : {300.0, 1000.0, 3000.0, 8000.0}) {
    Eigen::VectorXd start = Eigen::VectorXd::Constant(model.parameters(), 1e-3);
    start.head<3>() << k, 20.0, 1.0;
    const LeastSquaresFit fit = FitResponse(lines, model, start);
    if (fit.converged && (!best.converged || fit.cost < best.cost)) best = fit;
  }
  return best;
}

// RMS of (measured - fitted), divided by the RMS of the measured values.
double ResidualOf(std::span<const ResponseLine> lines, const HandModel& model, const Eigen::VectorXd& p) {
  double squared_errors = 0.0, squares = 0.0;
  for (const ResponseLine& line : lines) {
    squared_errors += std::norm(line.value - model(p, line.hz));
    squares += std::norm(line.value);
  }
  return std::sqrt(squared_errors / squares);
}

}  // namespace

tl::expected<HandFit, std::string> FitHand(std::span<const ResponseLine> lines, double tool_mass_kg,
                                           const HandFitOptions& options) {
  std::vector<ResponseLine> used;
  for (const ResponseLine& line : lines)
    if (line.hz <= options.max_hz) {
      used.push_back(line);
      // no line gets a smaller deviation than the accuracy of the model
      used.back().sd = std::hypot(line.sd, options.accuracy * std::abs(line.value));
    }
  if (used.size() < 4) return tl::unexpected(fmt::format("found {} lines, accepted 4 or more", used.size()));
  HandModel model{.tool_mass_kg = tool_mass_kg, .has_grip = false, .delay_s = options.delay_s};
  LeastSquaresFit best = FitHandModel(used, model);
  const HandModel with_grip{.tool_mass_kg = tool_mass_kg, .has_grip = true, .delay_s = options.delay_s};
  if (!best.converged || Chi2Of(best, used.size()) > kExactChi2)
    if (const LeastSquaresFit grip = FitHandModel(used, with_grip);
        grip.converged && grip.parameters[3] > 0.0 &&
        (!best.converged || Chi2Of(grip, used.size()) * kGripGain < Chi2Of(best, used.size()))) {
      best = grip;
      model = with_grip;
    }
  if (!best.converged) return tl::unexpected(std::string("no hand fits the force"));
  const double chi2 = Chi2Of(best, used.size());
  HandFit fit{.stiffness_N_per_m = {best.parameters[0], Width(best, chi2, 0)},
              .damping_Ns_per_m = {best.parameters[1], Width(best, chi2, 1)},
              .mass_kg = {best.parameters[2], Width(best, chi2, 2)},
              .chi2 = chi2,
              .residual = ResidualOf(used, model, best.parameters)};
  if (model.has_grip) fit.grip_time_s = {best.parameters[3], Width(best, chi2, 3)};
  fit.delay_s = {model.Delay_s(best.parameters),
                 options.delay_s ? 0.0 : Width(best, chi2, model.parameters() - 1)};
  return fit;
}

}  // namespace osteon::studies
