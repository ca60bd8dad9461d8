#pragma once

#include "control/hand_wrench.h"
#include "control/rt/marker.h"
#include "kinematics/spatial.h"

// What the force sensor feels of the tool's own mass when it is accelerated.
//
//     F_S = F_hand + weight - inertia      so      F_hand = F_S - weight + share inertia
//
// Without it the hand feels the tool's mass on top of the virtual one. The acceleration is that of the
// **measured** motion: the sensor feels what the arm does. The commanded one is known earlier by the arm's
// lag and dead time (some 20 ms), so that what would be taken out is not what is in the reading yet, and at 5
// Hz it is half a radian off; and it would close a loop through the law alone, a+ = share m_tool a /
// m_virtual, in which the arm has no part.
//
// It is positive feedback. What is left of the tool's mass at w is m (1 - share H(jw)), with H the filters
// and the sensor's delay: their lag makes a negative drag of about 2 share m w^2 / w_c. What the loop of a
// hand, the arm and the law stands of it is in hil/stability (AdmittanceLoopParams::inertia_share).

namespace osteon::control {

/// How a body moves, from its poses. Plain enough to be set and read: hil/stability makes a matrix of it.
struct MeasuredMotion {
  Pose X{Pose::Identity()};  ///< in the last step
  Twist V;                   ///< velocity of its frame, in W, filtered
  Twist A;                   ///< its rate of change, filtered: dv/dt of the origin, dw/dt
};

/// One step: backward differences, each through a filter of first order with the corner `filter_hz`. Linear
/// in the poses' translations.
void StepMotion(const Pose& X, double filter_hz, double dt_s, MeasuredMotion& motion) OSTEON_RT;

/// What it takes to move the tool as its flange moves, on the tool at To, in W:
///
///     f = m a_c,   a_c = a + alpha × r + w × (w × r),   r = p_c - p_F
///     t = I alpha + w × I w + (p_c - p_T) × f                          I about c, in W
///
/// @param motion  of the flange F
[[nodiscard]] Wrench InertiaWrench(const ForceSensorParams& params, const MeasuredMotion& motion,
                                   const Vector3& p_WT) OSTEON_RT;

}  // namespace osteon::control
