#pragma once

#include "control/hand_wrench.h"
#include "kinematics/spatial.h"

namespace osteon::hil {

/// What the sensor between flange and tool carries of hand and weight, at S's origin, in S. Written apart
/// from control::HandWrench, which takes it apart again.
/// @param F_hand_T_W  on T at To, in W
[[nodiscard]] Wrench SensorLoad(const control::ForceSensorParams& sensor, const Pose& X_WT, const Pose& X_WF,
                                const Wrench& F_hand_T_W);

/// That load less what the tool beyond the sensor takes for itself where it is accelerated: Newton's and
/// Euler's equations at its centre of mass.
/// @param F_S  SensorLoad  @param V_WT, A_WT  velocity of T and its rate of change, at To, in W
[[nodiscard]] Wrench LessInertia(const control::ForceSensorParams& sensor, const Wrench& F_S,
                                 const Pose& X_WT, const Pose& X_WF, const Twist& V_WT, const Twist& A_WT);

}  // namespace osteon::hil
