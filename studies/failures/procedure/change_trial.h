#pragma once

#include <vector>

#include "control/loop/servo_loop.h"
#include "control/setup/loop_tool.h"
#include "kinematics/lbr_arm.h"

namespace osteon::studies {

/// A run in which a servo loop renders in free space, is paused, switches to the second tool of its table,
/// and resumes. The arm follows each command a tick later; nobody holds the tool.
struct ChangeTrialParams {
  std::vector<control::LoopTool> tools;  ///< the loop's table: the first and the second tool
  /// False (a baseline): the loop keeps the first tool's entry, although the second tool is mounted.
  bool changes_entry{true};
  double mounted_kg{0.0};  ///< mass that the change adds to the sensor's load
  double seconds_after{2.0};
};

/// The result of the run. "Before" and "after" are the ticks directly before and after the change.
struct ChangeTrial {
  /// Commanded joints [rad].
  kinematics::JointVector q_before{kinematics::JointVector::Zero()}, q_after{kinematics::JointVector::Zero()};
  Pose X_before{Pose::Identity()}, X_after{Pose::Identity()};  ///< commanded pose of the tool, in W
  std::vector<double> speed_mm_per_s;  ///< speed of the apex in each tick after the resume
  bool fault{false};
};

/// Simulates the run. Deterministic.
[[nodiscard]] ChangeTrial RunChangeTrial(const ChangeTrialParams& params);

/// A reamer on the flange; its length to the apex grows with its radius. @param mass_kg  mass that the sensor
/// carries
[[nodiscard]] control::LoopTool ReamerOnFlange(double diameter_m, double mass_kg);

}  // namespace osteon::studies
