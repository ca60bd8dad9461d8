#pragma once

#include "base/marker.h"
#include "control/compliance/compliant_link.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// A bone on a compliant holder: a rigid mass on springs and dampers along and about the axes of W, in series
/// with pads that creep. Rotations are about the mount's point Mo. Each triple has a value for x, y and z.
/// Every field has a usable default: 12 kg at 10 Hz.
struct BoneMountParams {
  Vector3 p_WMo_m{Vector3::Zero()};  ///< position of Mo at rest, in W
  double mass_kg{12.0};
  Vector3 inertia_kg_m2{Vector3::Constant(0.12)};
  Vector3 stiffness_N_per_m{Vector3::Constant(47.4e3)};
  Vector3 stiffness_Nm_per_rad{Vector3::Constant(2e3)};
  double damping_ratio{0.05};                    ///< damping ratio zeta of each axis alone; >= 0
  double creep_N_per_m{0.0};                     ///< stiffness of the pads; 0: they do not creep
  double creep_tau_s{20.0};                      ///< time constant of the pads; > 0
  double max_shift_m{0.010}, max_turn_rad{0.1};  ///< largest displacement; beyond it the cell stops; > 0
};

/// State of a mount between ticks, in W: displacement d and velocity v of its mass (translation of Mo, then
/// rotation about Mo), and displacement and velocity of the pads.
struct BoneMountState {
  Vector6 d{Vector6::Zero()}, v{Vector6::Zero()};
  Vector3 creep_m{Vector3::Zero()}, creep_m_per_s{Vector3::Zero()};
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const BoneMountParams& params);

/// One tick of the mount, semi-implicit Euler:
///
///     (M + T D) v+ = M v - T (F_Mo + K d),   d+ = d + T v+        D = 2 zeta sqrt(K M), axis by axis
///
/// The pads are a massless element (StepMassless) with x_inf = -f / k_creep. M and I are mass and inertia, K
/// is the stiffness, T the period. The mount alone is stable for w T < 2, with w² = K / m. In contact with a
/// spring of stiffness K_c, sqrt((K + K_c) / m) T <= 0.4 is needed.
/// @param F_Mo_W  wrench that the bone exerts on the tool, at Mo, in W; the opposite wrench acts on the mount
void StepMount(const BoneMountParams& params, const Wrench& F_Mo_W, double period_s,
               BoneMountState& state) OSTEON_RT;

/// Pose in W of the frame M, which moves with the bone. It is the identity while the mount is undeformed.
[[nodiscard]] Pose MountPose(const BoneMountParams& params, const BoneMountState& state) OSTEON_RT;
/// Velocity of M at the point p_W, in W.
[[nodiscard]] Twist MountTwistAt(const BoneMountParams& params, const BoneMountState& state,
                                 const Vector3& p_W) OSTEON_RT;

}  // namespace osteon::control
