#pragma once

#include <algorithm>

namespace osteon::simulation {

/// Smallest product K c (stiffness of the virtual coupling times compliance of a part) that a hand feels. The
/// force then falls by 7 %: 1 - 1 / (1 + K c) = 0.07.
inline constexpr double kNoticedProduct = 0.0753;

/// A part of a cell that may yield (tool, tissue or mount), with the force on it and the scene's accepted
/// error.
struct ComplianceFigures {
  double compliance_m_per_N{0.0};  ///< c, the tangent compliance at the touching point
  double force_N{0.0};  ///< F on the part: lateral force on a tool, pushing force on tissue or mount
  double gives_m{0.0};  ///< displacement under F; 0: the part is linear, c F
  double stiffness_N_per_m{20e3};  ///< K, stiffness of the virtual coupling
  double error_m{0.1e-3};          ///< E, accepted error of the scene
};

/// Effect of a part that yields, compared with a rigid part.
struct ComplianceEffect {
  double gives_m{0.0};       ///< displacement under the force
  double product{0.0};       ///< K c
  double felt_share{0.0};    ///< relative change of the rendered stiffness: 1 / (1 + K c) - 1, at most 0
  bool is_displaced{false};  ///< the displacement is above E
  bool is_felt{false};       ///< K c is above kNoticedProduct

  [[nodiscard]] constexpr bool matters() const { return is_displaced || is_felt; }
};

/// Computes whether the part's compliance matters in the scene: it changes the force by more than 7 %, or the
/// depth by more than E.
[[nodiscard]] constexpr ComplianceEffect EffectOf(const ComplianceFigures& f) {
  ComplianceEffect effect;
  effect.gives_m = f.gives_m > 0.0 ? f.gives_m : f.compliance_m_per_N * f.force_N;
  effect.product = f.compliance_m_per_N * f.stiffness_N_per_m;
  effect.felt_share = 1.0 / (1.0 + effect.product) - 1.0;
  effect.is_displaced = effect.gives_m > f.error_m;
  effect.is_felt = effect.product > kNoticedProduct;
  return effect;
}

/// Lateral force for which a tool's bending is judged: the lateral force that the cell can exert, but at most
/// the pushing force.
[[nodiscard]] constexpr double LateralForce_N(double available_N, double push_N) {
  return std::min(available_N, push_N);
}

}  // namespace osteon::simulation
