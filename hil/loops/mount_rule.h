#pragma once

#include "control/compliance/bone_mount.h"
#include "hil/loops/admittance_loop.h"

// Effect of a mounted bone on the virtual tool (mass m_v). Above the mount's natural frequency the bone
// behaves like a free mass m_eff, and a coupling of stiffness K to it acts like a fixed wall of stiffness K
// (1 + m_v / m_eff).

namespace osteon::hil {

/// Result of the mass rule (docs/theory/compliance.md, rule 2): whether a mount satisfies it, and the mass
/// that the mount needs. m_eff is the smallest effective mass of the mounted bone at a point, over all
/// directions of the force:
///
///     1/m_eff = 1/m + largest eigenvalue of [r]^T I^-1 [r],   r from Mo to the point
struct MassRule {
  /// K (1 + m_v / m_eff): the loop with a rigid wall must be stable up to this stiffness.
  double stiffness_N_per_m{0.0};
  /// End of the stable range that begins at K; equals K if the loop is unstable at K.
  double stable_up_to_N_per_m{0.0};
  bool kept{true};
  /// The smallest mass of the mounted bone that satisfies the rule with this inertia and lever; infinite if
  /// no mass does.
  double min_mass_kg{0.0};
};

/// @param rigid  hand, arm and law of the loop; its wall is replaced  @param stiffness_N_per_m  K of the
/// coupling
/// @param p_W_m  the point, in W
/// Source: docs/theory/compliance.md, rule 2.
[[nodiscard]] MassRule CheckMass(AdmittanceLoopParams rigid, double stiffness_N_per_m,
                                 const control::BoneMountParams& mount, const Vector3& p_W_m);

}  // namespace osteon::hil
