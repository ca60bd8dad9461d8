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

constexpr double kTwoPi = 2.0 * std::numbers::pi, kTwoSd = 2.0;
constexpr double kResonanceGain = 3.0, kBadChi2 = 3.0;
constexpr double kExactChi2 = 0.1, kGripGain = 2.0;
constexpr double kMaxResonance = 1.5;  // factor on the highest line: beyond it nothing was measured

// Half width of the interval of parameter i, times a factor.
double Width(const LeastSquaresFit& fit, double chi2, Eigen::Index i, double factor = 1.0) {
  return kTwoSd * factor * std::sqrt(std::max(1.0, chi2) * std::max(0.0, fit.covariance(i, i)));
}

Complex Inertia(const Eigen::VectorXd& p, double hz) {
  const double w = kTwoPi * hz;
  return p[0] * w * w * std::polar(1.0, -w * p[1]);
}

Complex Resonance(double resonance_hz, double damping, double hz) {
  const double w_r = kTwoPi * resonance_hz, w = kTwoPi * hz;
  return w_r * w_r / Complex(w_r * w_r - w * w, 2.0 * damping * w_r * w);
}

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
  // start of the fit: the weighted mean of F / (x w^2)
  double over = 0.0, under = 0.0;
  for (const ResponseLine& line : lines) {
    const double w2 = kTwoPi * line.hz * kTwoPi * line.hz, weight = w2 * w2 / (line.sd * line.sd);
    over += weight * (line.value / w2).real();
    under += weight;
  }
  const LeastSquaresFit rigid = FitResponse(lines, Inertia, Eigen::Vector2d(over / under, 0.0));
  if (!rigid.converged) return tl::unexpected(std::string("no mass fits the force"));
  const double chi2 = Chi2Of(rigid, lines.size());
  ToolForceFit fit{.mass_kg = {rigid.parameters[0], Width(rigid, chi2, 0)},
                   .delay_s = {rigid.parameters[1], Width(rigid, chi2, 1)},
                   .resonance = {},
                   .chi2 = chi2};
  if (chi2 > kBadChi2)
    if (const LeastSquaresFit bent = FitResonance(lines, rigid.parameters); bent.converged) {
      const double less = Chi2Of(bent, lines.size());
      const double hz = std::exp(bent.parameters[2]), damping = std::exp(bent.parameters[3]);
      if (less * kResonanceGain < chi2 && hz <= kMaxResonance * lines.back().hz) {
        fit = {.mass_kg = {bent.parameters[0], Width(bent, less, 0)},
               .delay_s = {bent.parameters[1], Width(bent, less, 1)},
               .resonance = ResonanceFit{.hz = {hz, Width(bent, less, 2, hz)},
                                         .damping_ratio = {damping, Width(bent, less, 3, damping)}},
               .chi2 = less};
      }
    }
  if (!(fit.mass_kg.value > 1.5 * fit.mass_kg.half_width))
    return tl::unexpected(
        fmt::format("the force sensor shows no inertia of the tool: found {:.3f} ± {:.3f} kg",
                    std::max(0.0, fit.mass_kg.value), fit.mass_kg.half_width));
  return fit;
}

namespace {

// A hand with the parameters k, b, m, then grip time and delay if they are fitted, in this order.
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

// RMS of measured less fitted, over the RMS of the measured.
double ResidualOf(std::span<const ResponseLine> lines, const HandModel& model, const Eigen::VectorXd& p) {
  double off = 0.0, all = 0.0;
  for (const ResponseLine& line : lines) {
    off += std::norm(line.value - model(p, line.hz));
    all += std::norm(line.value);
  }
  return std::sqrt(off / all);
}

}  // namespace

tl::expected<HandFit, std::string> FitHand(std::span<const ResponseLine> lines, double tool_mass_kg,
                                           const HandFitOptions& options) {
  std::vector<ResponseLine> used;
  for (const ResponseLine& line : lines)
    if (line.hz <= options.max_hz) {
      used.push_back(line);
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
