#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

#include "hil/loops/admittance_loop.h"

// Model B of docs/theory/stability.md in plain scalars: a critically damped arm with a dead time of at least
// one period, and a wall without damping. An oracle of hil/loops/admittance_loop.h, with which it shares only
// the parameters.

namespace osteon::studies {

/// How the acceleration of the hand's mass is computed in sample k, from the arm's velocity v, position x,
/// command x_c, bandwidth w [rad/s] and the period T.
enum class HandAcceleration {
  kMeanOfPeriod,      ///< (v[k] - v[k-1]) / T
  kAfterCommandStep,  ///< w^2 (x_c - x) - 2 w v, with the newest command x_c
};

/// Spectral radius of the loop's matrix over one period, exact to rounding; < 1: stable.
[[nodiscard]] inline double AdmittanceModelRadius(const hil::AdmittanceLoopParams& p, HandAcceleration kind) {
  const double T = p.period_s, w = 2.0 * std::numbers::pi * p.arm.bandwidth_hz, decay = std::exp(-w * T);
  const int dead = static_cast<int>(p.arm.dead_cycles), age = p.wall.age_ticks;
  // state: commands (newest first), the arm's x and v, v one period before, the virtual tool's v, earlier
  // measured forces (newest first)
  const int commands = std::max(dead, age + 1), x_at = commands, law_at = commands + 3,
            felt_at = commands + 4;
  const int size = felt_at + p.sensor_delay;
  Eigen::MatrixXd loop(size, size);
  for (int column = 0; column < size; ++column) {
    const Eigen::VectorXd s = Eigen::VectorXd::Unit(size, column);
    const double x = s[x_at], v = s[x_at + 1], target = s[dead - 1];
    const double a =
        kind == HandAcceleration::kMeanOfPeriod ? (v - s[x_at + 2]) / T : w * w * (target - x) - 2.0 * w * v;
    const double felt = -(p.hand.stiffness_N_per_m * x + p.hand.damping_Ns_per_m * v + p.hand.mass_kg * a);
    const double sensed = p.sensor_delay == 0 ? felt : s[felt_at + p.sensor_delay - 1];
    const double wall = p.wall.stiffness_N_per_m * (p.wall.on == hil::WallOn::kMeasured ? x : s[age]);
    const double law =
        (s[law_at] + T / p.mass_kg * (sensed - wall)) / (1.0 + T * p.damping_Ns_per_m / p.mass_kg);
    Eigen::VectorXd next(size);
    next[0] = s[0] + T * law;
    for (int i = 1; i < commands; ++i) next[i] = s[i - 1];
    const double off = x - target;
    next[x_at] = target + decay * ((1.0 + w * T) * off + T * v);
    next[x_at + 1] = decay * (-w * w * T * off + (1.0 - w * T) * v);
    next[x_at + 2] = v;
    next[law_at] = law;
    for (int i = 0; i < p.sensor_delay; ++i) next[felt_at + i] = i == 0 ? felt : s[felt_at + i - 1];
    loop.col(column) = next;
  }
  return Eigen::EigenSolver<Eigen::MatrixXd>(loop, false).eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace osteon::studies
