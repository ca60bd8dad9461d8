#pragma once

#include <vector>

#include "hil/operator/hand_script.h"

namespace osteon::hil {

/// Parameters of an operator who works with the tools of a plan, one after the other.
struct ProcedureScriptParams {
  PlainPose X_WC{};  ///< the plan: its centre, +z along its axis, out of the cup or the opening
  /// Radius of the head of the simulated arm's tool; the tool rotates about the head's centre.
  double head_radius_m{0.022};
  double tool_yaw_rad{0.0};
  double seconds{60.0};            ///< duration of the whole script, >= 0.1
  double start_height_m{0.040};    ///< heights of the head's centre over X_WC
  double retract_height_m{0.030};  ///< height to which each tool is retracted before it is changed
  double approach_m{0.010};  ///< distance above the planned height to which each tool moves without a push
  std::vector<double> heights_m{};  ///< planned height of each tool, in the order of use; at least one
  /// Radius of the circle about the axis on which each tool moves while it goes down. Empty, or 0: the tool
  /// moves straight down.
  std::vector<double> around_m{};
  double loop_period_s{0.8};  ///< duration of one turn on the circle
  /// If the operator does not see the plan, the hand's target lies this far below the planned height. With a
  /// hand of 2 N/mm, the hand still presses with 30 N at the planned height.
  double past_plan_m{0.015};
  /// True: the operator sees how far each tool is above its planned height, and stops pushing there. False:
  /// the operator does not stop.
  bool sees_plan{true};
  /// Stiffness of the coupling. The operator sees the simulated tool, which stays behind the handle by the
  /// coupling's deflection.
  double coupling_N_per_m{20'000.0};
  /// Ratio of the last tool's push time to that of each other tool; >= 1. The last tool cuts with its whole
  /// head and is the slowest, so it needs more time to reach its planned height.
  double last_push_ratio{1.0};
  /// Shortest time [s] of each other tool, which a change of tool at rest needs. If the script is too short
  /// for last_push_ratio with this time, a smaller ratio is used.
  double min_tool_s{5.0};
  double push_force_N{60.0};
  double approach_force_N{20.0};
  double tilt_rad{0.0};  ///< angle between the tool's axis and the plan's axis (an incorrectly held tool)
  double aside_m{0.0};   ///< distance of the hand's axis from the plan's
  double hand_stiffness_N_per_m{2000.0};
  double max_target_m_per_s{0.2};
};

/// Makes a script with these phases for each tool: approach, push to the planned height, retract, and hold
/// the tool for its change. A tool with a circle (around_m) first widens the rim at the end of the approach,
/// and then goes down in loops; below a narrow rim its shank would touch the wall. An expert's hand stays on
/// the plan's axis (tilt_rad and aside_m 0) and stops pushing at the planned height. A novice's hand is
/// tilted and aside all the time, and does not stop pushing. A loop is never faster than max_target_m_per_s.
/// @throws std::invalid_argument, naming the parameter and what is accepted.
[[nodiscard]] HandScript MakeProcedureScript(const ProcedureScriptParams& params);

/// A time in which the hand holds a retracted tool, so that it can be changed.
struct ToolHold {
  double begin_s{0.0}, length_s{0.0};  ///< since the script began
};

/// Returns the holds, one after each tool except the last.
/// @param script  result of MakeProcedureScript
[[nodiscard]] std::vector<ToolHold> HoldsForChanges(const HandScript& script);

}  // namespace osteon::hil
