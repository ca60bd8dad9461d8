#pragma once

#include "control/compliance/bone_mount.h"
#include "hil/loops/admittance_loop.h"

// A bone on a mount, seen by the virtual tool: above the mount's own frequency it is a mass of its own, on
// which the coupling is as stiff as a wall of K (1 + m_v / m_eff).

namespace osteon::hil {

/// Whether a mount keeps the mass rule, and what it needs. m_eff is the least mass that the mount opposes to
/// a force at a point, over all directions:
///
///     1/m_eff = 1/m + greatest eigenvalue of [r]^T I^-1 [r],   r from Mo to the point
struct MassRule {
  double stiffness_N_per_m{0.0};  ///< K (1 + m_v / m_eff): up to it the loop on a rigid bone must be stable
  double stable_up_to_N_per_m{0.0};  ///< the first unstable stiffness from K on; K itself: already that
  bool kept{true};
  /// The least mass that keeps the rule at this inertia and lever; infinite: none does.
  double min_mass_kg{0.0};
};

/// @param rigid  hand, arm and law; its wall is replaced  @param stiffness_N_per_m  K of the coupling
/// @param p_W_m  the point, in W
/// Source: docs/theory/compliance.md, rule 2.
[[nodiscard]] MassRule CheckMass(AdmittanceLoopParams rigid, double stiffness_N_per_m,
                                 const control::BoneMountParams& mount, const Vector3& p_W_m);

}  // namespace osteon::hil
