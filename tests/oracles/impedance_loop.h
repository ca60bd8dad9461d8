#pragma once

#include "hil/loops/linear_loop.h"

namespace osteon::studies {

/// Model A of docs/theory/stability.md: an impedance device, a mass on a viscous axis that receives a
/// force command.
struct ImpedanceLoopParams {
  double mass_kg{0.5};                 ///< m
  double damping_Ns_per_m{2.0};        ///< b, the device's own; > 0
  double wall_stiffness_N_per_m{1e3};  ///< K
  double wall_damping_Ns_per_m{0.0};   ///< B
  int delay{0};                        ///< d [ticks]
  double period_s{0.001};              ///< T
};

/// The loop, exact between samples (zero-order hold):
///
///     m x'' + b x' = u,   u_k = -K x_{k-d} - B (x_{k-d} - x_{k-d-1}) / T
///
/// State: x now and before (d + 2 samples), x'.
/// @throws std::invalid_argument if m, b or T is not > 0, or d < 0.
class ImpedanceLoop {
 public:
  explicit ImpedanceLoop(const ImpedanceLoopParams& params);
  [[nodiscard]] int size() const { return params_.delay + 3; }
  [[nodiscard]] Eigen::VectorXd Step(const Eigen::VectorXd& state) const;
  [[nodiscard]] double SpectralRadius() const;

 private:
  ImpedanceLoopParams params_;
};

/// The largest wall stiffness up to which the loop is stable [N/m]: the scan's first crossing.
[[nodiscard]] hil::Boundary MaxWallStiffness(ImpedanceLoopParams params,
                                             const hil::BoundaryScan& scan = {.from = 1.0, .to = 1e6});

/// The device's own damping that makes the device passive with any hand. This condition is stricter than
/// stability:
///
///     b > max over th of (K T / 2) sin((2d+1) th/2) / sin(th/2) - B cos((d+1) th)
///
/// Source: Colgate and Schenkel, Passivity of a class of sampled-data systems, J. Robotic Systems 14, 1997,
/// with a delay of d samples.
/// @returns the smallest such b [N s/m].
[[nodiscard]] double PassiveDamping(const ImpedanceLoopParams& params);

}  // namespace osteon::studies
