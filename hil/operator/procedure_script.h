#pragma once

#include <vector>

#include "hil/operator/hand_script.h"

namespace osteon::hil {

/// Parameters of an operator who works with the tools of a plan, one after the other.
struct ProcedureScriptParams {
  PlainPose X_WC{};  ///< the plan: its centre, +z along its axis, out of the cup or the opening
  /// Radius of the head that the simulated arm carries: the tool turns about its centre.
  double head_radius_m{0.022};
  double tool_yaw_rad{0.0};
  double seconds{60.0};             ///< of the whole script, >= 0.1
  double start_height_m{0.040};     ///< heights of the head's centre over X_WC
  double retract_height_m{0.030};   ///< to which each tool is retracted before it is changed
  double approach_m{0.010};         ///< height over the planned one to which each tool is led without a push
  std::vector<double> heights_m{};  ///< planned height of each tool, in their order; at least one
  /// Radius about the axis at which each tool is led around while it goes down; empty, or 0: straight.
  std::vector<double> around_m{};
  double loop_period_s{0.8};  ///< of one turn around
  /// The target of a hand that does not see the plan lies this far below the planned height: with 2 N/mm it
  /// still presses with 30 N there.
  double past_plan_m{0.015};
  /// The operator sees how far each tool is above its planned height, and lets up there; false: pushes on.
  bool sees_plan{true};
  /// The operator sees the simulated tool, which the coupling's spring lets stand back from the handle.
  double coupling_N_per_m{20'000.0};
  /// The last tool is pushed this many times as long as each other one, so that it comes to its planned
  /// place: its whole head cuts, so it is the slowest. >= 1.
  double last_push_ratio{1.0};
  /// Least time [s] that the longer push leaves to each other tool, because a change at rest needs it. In a
  /// script that is too short for last_push_ratio, the ratio is smaller.
  double min_tool_s{5.0};
  double push_force_N{60.0};
  double approach_force_N{20.0};
  double tilt_rad{0.0};  ///< of the tool's axis away from the plan's: a tool that is held wrong
  double aside_m{0.0};   ///< distance of the hand's axis from the plan's
  double hand_stiffness_N_per_m{2000.0};
  double max_target_m_per_s{0.2};
};

/// For each tool: approach, push to the planned height, retract, and hold the tool where it is changed. A
/// tool that is led around widens first, where the approach ends, and goes down in loops: below a rim that is
/// not wide enough its shank would meet the wall. The hand of an expert keeps to the plan's axis (tilt and
/// aside 0) and lets up at the planned height; a novice's is tilted and aside all the time, and pushes on. A
/// loop is never faster than max_target_m_per_s.
/// @throws std::invalid_argument, naming the parameter and what is accepted.
[[nodiscard]] HandScript MakeProcedureScript(const ProcedureScriptParams& params);

/// A time in which the hand holds a retracted tool, so that it can be changed.
struct ToolHold {
  double begin_s{0.0}, length_s{0.0};  ///< since the script began
};

/// The holds after each tool but the last.
/// @param script  of MakeProcedureScript
[[nodiscard]] std::vector<ToolHold> HoldsForChanges(const HandScript& script);

}  // namespace osteon::hil
