#pragma once

#include "control/sensing/hand_wrench.h"
#include "kinematics/spatial.h"

namespace osteon::hil {

/// Returns the load on the sensor between flange and tool, from the hand and from the tool's weight, at S's
/// origin, in S. Written independently of its inverse, control::HandWrench.
/// @param F_hand_T_W  the hand's wrench on the tool, at To, in W
[[nodiscard]] Wrench SensorLoad(const control::ForceSensorParams& sensor, const Pose& X_WT, const Pose& X_WF,
                                const Wrench& F_hand_T_W);

/// Motion of sensor and tool that SubtractInertia needs.
struct SensorMotion {
  const Pose& X_WT;
  const Pose& X_WF;
  Twist V_WT{}, A_WT{};  ///< velocity of T and its rate of change, at To, in W
};

/// Subtracts from a load the wrench that accelerates the tool, by Newton's and Euler's equations at the
/// tool's centre of mass.
/// @param F_S  result of SensorLoad
[[nodiscard]] Wrench SubtractInertia(const control::ForceSensorParams& sensor, const Wrench& F_S,
                                     const SensorMotion& motion);

}  // namespace osteon::hil
