#pragma once

#include "control/compliance/bone_mount.h"
#include "hil/loops/admittance_loop.h"

// A bone on a mount, as the virtual tool feels it. Above the mount's natural frequency the bone is a free
// mass m_eff, and the coupling to it acts like a fixed wall of stiffness K (1 + m_v / m_eff).

namespace osteon::hil {

/// Whether a mount keeps the mass rule, and the mass that it needs. m_eff is the smallest effective mass of
/// the mounted bone at a point, over all directions of the force:
///
///     1/m_eff = 1/m + largest eigenvalue of [r]^T I^-1 [r],   r from Mo to the point
struct MassRule {
  double stiffness_N_per_m{0.0};  ///< K (1 + m_v / m_eff): up to it the loop on a rigid bone must be stable
  double stable_up_to_N_per_m{0.0};  ///< end of the stable range from K on; K: unstable at K
  bool kept{true};
  /// The smallest mass that keeps the rule at this inertia and lever; infinite: no mass does.
  double min_mass_kg{0.0};
};

/// @param rigid  hand, arm and law; its wall is replaced  @param stiffness_N_per_m  K of the coupling
/// @param p_W_m  the point, in W
/// Source: docs/theory/compliance.md, rule 2.
[[nodiscard]] MassRule CheckMass(AdmittanceLoopParams rigid, double stiffness_N_per_m,
                                 const control::BoneMountParams& mount, const Vector3& p_W_m);

}  // namespace osteon::hil
