#pragma once

#include "base/marker.h"
#include "control/sensing/hand_wrench.h"
#include "kinematics/spatial.h"

// The force on the tool's own mass in the force sensor's reading, when the tool is accelerated.
//
//     F_S = F_hand + weight - inertia      so      F_hand = F_S - weight + share inertia
//
// Without this the hand feels the tool's mass on top of the virtual one. The acceleration is that of the
// **measured** motion, because the sensor feels what the arm does. The commanded acceleration is known
// earlier by the arm's lag and dead time (some 20 ms): it would compensate a force that is not in the reading
// yet, half a radian off at 5 Hz. It would also close a loop through the law alone, a+ = share m_tool a /
// m_virtual, without the arm.
//
// The compensation is positive feedback. At the frequency w it leaves m (1 - share H(jw)) of the tool's mass,
// with H the filters and the sensor's delay: their lag makes a negative drag of about 2 share m w^2 / w_c.
// How much of it the loop of hand, arm and law tolerates is in studies/stability
// (AdmittanceLoopParams::inertia_share).

namespace osteon::control {

/// Motion of a body, computed from its poses. Plain data: studies/stability makes a matrix of it.
struct MeasuredMotion {
  Pose X{Pose::Identity()};  ///< in the last step
  Twist V;                   ///< velocity of its frame, in W, filtered
  Twist A;                   ///< its rate of change, filtered: dv/dt of the origin, dw/dt
};

/// One step: backward differences, each through a first-order filter with the corner `filter_hz`. Linear in
/// the translations of the poses.
void StepMotion(const Pose& X, double filter_hz, double dt_s, MeasuredMotion& motion) OSTEON_RT;

/// Wrench that accelerates the tool as its flange moves, on the tool at To, in W:
///
///     f = m a_c,   a_c = a + alpha × r + w × (w × r),   r = p_c - p_F
///     t = I alpha + w × I w + (p_c - p_T) × f                          I about c, in W
///
/// @param motion  of the flange F
[[nodiscard]] Wrench InertiaWrench(const ForceSensorParams& params, const MeasuredMotion& motion,
                                   const Vector3& p_WT) OSTEON_RT;

}  // namespace osteon::control
