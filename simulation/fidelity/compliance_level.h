#pragma once

#include <algorithm>

namespace osteon::simulation {

/// Smallest product of coupling stiffness and compliance that a hand feels: 7 % of the force,
/// 1 - 1 / (1 + K c) = 0.07.
inline constexpr double kNoticedProduct = 0.0753;

/// A part of a cell that may give way, and what it meets.
struct ComplianceFigures {
  double compliance_m_per_N{0.0};  ///< c, the tangent compliance at the touching point
  double force_N{0.0};             ///< F on the part: lateral for a tool, the push for tissue and mount
  double gives_m{0.0};             ///< displacement under F; 0: c F, as for a linear part
  double stiffness_N_per_m{20e3};  ///< K, stiffness of the virtual coupling
  double error_m{0.1e-3};          ///< E, accepted error of the scene
};

/// Effect of a part that gives way, compared with a rigid one.
struct ComplianceEffect {
  double gives_m{0.0};       ///< displacement under the force
  double product{0.0};       ///< K c
  double felt_share{0.0};    ///< change of the felt stiffness: 1 / (1 + K c) - 1, at most 0
  bool is_displaced{false};  ///< it gives more than E
  bool is_felt{false};       ///< K c is beyond kNoticedProduct

  [[nodiscard]] constexpr bool matters() const { return is_displaced || is_felt; }
};

/// Whether a scene can notice that a part gives way: its force changes by 7 % or its depth by E.
[[nodiscard]] constexpr ComplianceEffect EffectOf(const ComplianceFigures& f) {
  ComplianceEffect effect;
  effect.gives_m = f.gives_m > 0.0 ? f.gives_m : f.compliance_m_per_N * f.force_N;
  effect.product = f.compliance_m_per_N * f.stiffness_N_per_m;
  effect.felt_share = 1.0 / (1.0 + effect.product) - 1.0;
  effect.is_displaced = effect.gives_m > f.error_m;
  effect.is_felt = effect.product > kNoticedProduct;
  return effect;
}

/// The lateral force that a tool must expect: what the cell keeps available, but no more than the push.
[[nodiscard]] constexpr double LateralForce_N(double available_N, double push_N) {
  return std::min(available_N, push_N);
}

}  // namespace osteon::simulation
