#pragma once

#include "control/hand_wrench.h"
#include "kinematics/spatial.h"

namespace osteon::hil {

/// What the sensor between flange and tool carries of hand and weight, at S's origin, in S. Written apart
/// from control::HandWrench, which takes it apart again.
/// @param F_hand_T_W  on T at To, in W
[[nodiscard]] Wrench SensorLoad(const control::ForceSensorParams& sensor, const Pose& X_WT, const Pose& X_WF,
                                const Wrench& F_hand_T_W);

}  // namespace osteon::hil
