#pragma once

#include "base/marker.h"
#include "control/sensing/hand_wrench.h"
#include "kinematics/spatial.h"

// Compensation of the tool's inertial force in the force sensor's reading, when the tool is accelerated.
//
//     F_S = F_hand + weight - inertia      so      F_hand = F_S - weight + share inertia
//
// Without compensation, the hand feels the tool's mass in addition to the virtual mass. The acceleration is
// computed from the **measured** motion, because the sensor measures the force of the arm's actual motion.
// The commanded acceleration is ahead of the actual one by the arm's lag and dead time (some 20 ms), which is
// a phase error of half a radian at 5 Hz. It would compensate a force that is not in the reading yet. It
// would also close a feedback loop within the law, without the arm: next acceleration = share m_tool /
// m_virtual × present acceleration.
//
// The compensation is positive feedback. At the angular frequency w, the hand still feels the part m (1 -
// share H(jw)) of the tool's mass m. H is the transfer function of the two filters, with the corner frequency
// w_c, and of the sensor's delay. The filters' lag makes a negative drag of about 2 share m w^2 / w_c.
// studies/stability computes which share the loop of hand, arm and law tolerates
// (AdmittanceLoopParams::inertia_share).

namespace osteon::control {

/// Motion of a body, computed from its measured poses. Plain data, so that studies/stability can build the
/// matrix of StepMotion.
struct MeasuredMotion {
  Pose X{Pose::Identity()};  ///< pose in the last step
  Twist V;                   ///< velocity of the body's frame, in W, filtered
  Twist A;                   ///< derivative of V, filtered: dv/dt of the origin, and dw/dt
};

/// Updates the motion with a new pose. Velocity and acceleration are backward differences, each with a
/// first-order filter of the corner frequency `filter_hz`. The result is linear in the translations of the
/// poses.
void StepMotion(const Pose& X, double filter_hz, double dt_s, MeasuredMotion& motion) OSTEON_RT;

/// Wrench that gives the tool, which is rigidly attached to the flange, the flange's acceleration. On the
/// tool at To, in W:
///
///     f = m a_c,   a_c = a + alpha × r + w × (w × r),   r = p_c - p_F
///     t = I alpha + w × I w + (p_c - p_T) × f                          I about c, in W
///
/// @param motion  motion of the flange F
[[nodiscard]] Wrench InertiaWrench(const ForceSensorParams& params, const MeasuredMotion& motion,
                                   const Vector3& p_WT) OSTEON_RT;

}  // namespace osteon::control
