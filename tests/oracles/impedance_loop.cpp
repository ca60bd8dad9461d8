#include "tests/oracles/impedance_loop.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

namespace osteon::studies {

ImpedanceLoop::ImpedanceLoop(const ImpedanceLoopParams& params) : params_(params) {
  const auto require = [](const char* name, double found, bool ok, const char* accepted) {
    if (!ok || !std::isfinite(found))
      throw std::invalid_argument(
          fmt::format("impedance loop: {}: found {:g}, accepted {}", name, found, accepted));
  };
  require("mass_kg", params.mass_kg, params.mass_kg > 0.0, "> 0");
  require("damping_Ns_per_m", params.damping_Ns_per_m, params.damping_Ns_per_m > 0.0, "> 0");
  require("period_s", params.period_s, params.period_s > 0.0, "> 0");
  require("delay", params.delay, params.delay >= 0 && params.delay <= 1000, "0 … 1000");
}

Eigen::VectorXd ImpedanceLoop::Step(const Eigen::VectorXd& s) const {
  const int d = params_.delay, speed = d + 2;
  const double T = params_.period_s, m = params_.mass_kg, b = params_.damping_Ns_per_m;
  const double u =
      -params_.wall_stiffness_N_per_m * s[d] - params_.wall_damping_Ns_per_m * (s[d] - s[d + 1]) / T;
  // v' = (u - b v) / m with a constant u: v approaches u / b with the time constant m / b
  const double decay = std::exp(-b * T / m), tau = m / b, end = u / b;
  Eigen::VectorXd next(size());
  next[0] = s[0] + end * T + (s[speed] - end) * tau * (1.0 - decay);
  for (int i = 1; i < speed; ++i) next[i] = s[i - 1];
  next[speed] = end + (s[speed] - end) * decay;
  return next;
}

double ImpedanceLoop::SpectralRadius() const {
  return hil::SpectralRadius(hil::LoopMatrix([this](const Eigen::VectorXd& s) { return Step(s); }, size()));
}

hil::Boundary MaxWallStiffness(ImpedanceLoopParams params, const hil::BoundaryScan& scan) {
  return hil::FirstCrossing(
      [&](double stiffness) {
        params.wall_stiffness_N_per_m = stiffness;
        return ImpedanceLoop(params).SpectralRadius() < 1.0;
      },
      scan);
}

double PassiveDamping(const ImpedanceLoopParams& params) {
  constexpr int kAngles = 20'000;  // samples of th over (0, pi]
  const double d = params.delay, T = params.period_s;
  double most = 0.0;
  for (int i = 1; i <= kAngles; ++i) {
    const double th = std::numbers::pi * i / kAngles;
    most = std::max(most, 0.5 * params.wall_stiffness_N_per_m * T * std::sin((2.0 * d + 1.0) * th / 2.0) /
                                  std::sin(th / 2.0) -
                              params.wall_damping_Ns_per_m * std::cos((d + 1.0) * th));
  }
  return most;
}

}  // namespace osteon::studies
