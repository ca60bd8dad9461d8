#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/inheriting_mutex.h"
#include "kinematics/spatial.h"
#include "procedure/assessment/assessment.h"
#include "procedure/plan/surgical_plan.h"
#include "session/procedure/session_file.h"
#include "simulation/contact/contact_model.h"

namespace osteon::session {

/// The place of a tool relative to its planned place.
struct PlanPlace {
  /// Height of the head's centre over its planned place, along the plan's axis; negative: deeper than
  /// planned.
  double to_go_m{0.0};
  double aside_m{0.0};   ///< distance of the head's centre from the plan's axis
  double tilt_rad{0.0};  ///< angle between the feed and the axis into the bone
  bool beyond_tilt{false}, beyond_aside{false}, beyond_depth{false};  ///< outside of the plan's corridor
};
/// Computes the place of a tool relative to its planned place.
/// @param X_GT  pose of the tool in the bone's frame; its head's centre lies half the head's diameter behind
/// the apex
[[nodiscard]] PlanPlace PlaceAlongPlan(const procedure::SurgicalPlan& plan,
                                       const procedure::PlannedTool& tool, const Pose& X_GT);

/// Makes the two messages with which the console shows a procedure: the plan, which does not change, and the
/// state of the session. console/web/src/messages.ts has their fields.
///
/// Step is called on the frames' thread, the other functions on any thread.
class ProcedurePanel {
 public:
  /// @param X_WG pose of the bone in the world  @param confirms  a person confirms each change of tool
  ProcedurePanel(procedure::SurgicalPlan plan, const Pose& X_WG, bool confirms);

  /// Takes a frame. The place shown is that of the simulated tool, which cuts.
  /// @param tool  index in the plan  @param stamp stamp of the frame's pose
  void Step(int tool, const simulation::ContactModel& model, rt::Nanoseconds stamp);

  /// {"type": "plan", …}
  [[nodiscard]] const std::string& PlanJson() const { return plan_json_; }
  /// Makes {"type": "procedure", …}: step, depth to go, tilt, and the parts of the score that are known
  /// before the end.
  /// @param gain  guidance gain that is in force
  [[nodiscard]] std::string Json(const SessionFile& session, double gain) const;

 private:
  const procedure::SurgicalPlan plan_;
  const Pose X_GW_;
  const bool has_guidance_;
  std::string plan_json_;

  mutable rt::InheritingMutex mutex_;  // guards the following, for the frames' and pages' threads
  int tool_{-1};
  rt::Nanoseconds stamp_{0};  // stamp of the last frame
  PlanPlace place_;
  procedure::ReamedAxis axis_;      // mean axis of the tool in use
  double removed_m3_{0.0};          // volume removed by all tools up to the last frame
  double removed_by_tool_m3_{0.0};  // volume removed by the tool in use
  double outside_s_{0.0};           // cutting time outside of the plan's corridor
  bool known_{false};               // at least one frame was received
};

}  // namespace osteon::session
