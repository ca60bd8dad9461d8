#pragma once

#include <array>
#include <numbers>

#include "kinematics/lbr_params.h"

namespace osteon::kinematics {

/// The iiwa 14 R820: lengths of lbr_description, limits of KUKA's data sheet, accelerations as used in Drake.
inline const LbrParams& Iiwa14() {
  constexpr double rad = std::numbers::pi / 180.0;
  // Limits of A1 to A7: lower, upper [rad], velocity [rad/s], acceleration [rad/s^2], torque [N·m].
  static const LbrParams arm{.base_to_shoulder_m = 0.360,
                             .shoulder_to_elbow_m = 0.420,
                             .elbow_to_wrist_m = 0.400,
                             .wrist_to_flange_m = 0.126,
                             .limits = {JointLimits{-170 * rad, 170 * rad, 85 * rad, 8.57, 320.0},
                                        JointLimits{-120 * rad, 120 * rad, 85 * rad, 8.57, 320.0},
                                        JointLimits{-170 * rad, 170 * rad, 100 * rad, 8.74, 176.0},
                                        JointLimits{-120 * rad, 120 * rad, 75 * rad, 11.36, 176.0},
                                        JointLimits{-170 * rad, 170 * rad, 130 * rad, 12.23, 110.0},
                                        JointLimits{-120 * rad, 120 * rad, 135 * rad, 15.72, 40.0},
                                        JointLimits{-175 * rad, 175 * rad, 135 * rad, 15.72, 40.0}}};
  return arm;
}

}  // namespace osteon::kinematics
