#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/inheriting_mutex.h"
#include "procedure/assessment/assessment.h"
#include "procedure/plan/surgical_plan.h"
#include "session/procedure/pass_detector.h"
#include "session/procedure/session_file.h"
#include "simulation/bone/bone.h"
#include "simulation/bone/scene_events.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/solids/solid.h"

namespace osteon::session {

/// A session's score, as far as it is known before the session's end.
struct ScoreSoFar {
  procedure::Score score;   ///< an open item has no value and no points
  std::vector<bool> open;   ///< for each of score.items: the item has no value yet
  double open_points{0.0};  ///< weights of the open items
  std::string unfinished;   ///< what is left to do of the plan; empty: nothing
};

/// Scores the items that are known now (procedure::ScoreOf), and leaves three kinds open: items that the last
/// tool decides, until that tool has a pass that was not undone; items that need all recordings of the
/// session; items whose values could not be measured. So the total is never above that of `osteon assess` for
/// the same passes and rubric.
/// @param passes  all passes of the session, including undone ones
/// @param assessment  of the bone after these passes; its process figures are not used
/// @param walls_known  false: the walls beside some pass are not known, and a breach is assumed
[[nodiscard]] ScoreSoFar ScoreOfNow(const procedure::SurgicalPlan& plan, const procedure::Rubric& rubric,
                                    std::span<const SessionPass> passes,
                                    const procedure::Assessment& assessment, bool walls_known);

/// The plan, the rubric and the bone by which a running session is scored.
struct LiveScoreParams {
  procedure::SurgicalPlan plan;
  std::optional<procedure::Rubric> rubric{};  ///< absent: no score is given
  std::string without_rubric{};               ///< why the rubric is absent
  const simulation::Bone* bone{nullptr};      ///< the uncut bone; must outlive this object
  const simulation::Solid* solid{nullptr};    ///< the bone's solid; null: walls are not watched
  simulation::SceneEventParams walls{};       ///< the plan's scene limits for the watched walls
  Pose X_WG{Pose::Identity()};
};

/// The score of a running session, computed as `osteon assess` does. The score is that of the bone after the
/// last pass that was not undone; bone cut since then is not included. The age in the message is that of this
/// bone.
///
///     frames' thread ──AddFrame, EndPass, SetState──▶ [newest state] ──Update──▶ message ──Json──▶ pages
///
/// AddFrame, EndPass and SetState take some microseconds. Update measures the bone, which takes some tenths
/// of a second: the frames' thread never calls it.
class LiveScore {
 public:
  explicit LiveScore(LiveScoreParams params) : params_(std::move(params)) {}

  // frames' thread
  /// Adds a frame to the open pass.
  /// @param tool  index in the plan  @param begins  the frame is the first one of a pass
  void AddFrame(int tool, const simulation::ContactModel& model, double spindle_rad_per_s, bool begins);
  /// Ends the open pass. @param number  SessionPass::number of this pass
  void EndPass(int number);
  /// Sets the bone that is to be scored. @param stamp stamp of the newest frame @param guided guidance was on
  /// in a part of the session
  /// @returns whether an Update is due: the input has changed, and there is a rubric
  bool SetState(std::shared_ptr<const simulation::CarvedState> state, std::vector<SessionPass> passes,
                const std::optional<PlainPose>& cup_X_GT, bool guided, rt::Nanoseconds stamp);

  /// Scores the newest bone, unless that is already done. Call it from any thread but the frames' thread.
  void Update();

  /// Makes the message {"type": "score", …}; console/web/src/messages.ts has its fields. Any thread.
  /// @param now  stamp of the newest frame  @param in_pass a pass is open, which the score does not include
  [[nodiscard]] std::string Json(rt::Nanoseconds now, bool in_pass) const;

 private:
  // The facts about a pass's cut that the score needs.
  struct Trace {
    procedure::ReamedAxis axis;
    std::vector<Vector3> heads_m;  // centres of the head where bone was removed, at least kWallStep_m apart
  };
  // A state of the session that is to be scored.
  struct Input {
    std::shared_ptr<const simulation::CarvedState> state;
    std::vector<SessionPass> passes;
    std::optional<PlainPose> cup_X_GT;
    bool guided{false};
    rt::Nanoseconds stamp{0};
    std::map<int, std::shared_ptr<const Trace>> traces;  // traces of the passes, by pass number
  };
  // Measures the bone and the walls of a state, and scores it.
  [[nodiscard]] ScoreSoFar Measure(const Input& input) const;

  const LiveScoreParams params_;
  CutDetector cut_;                                     // the frames' thread alone uses it and the next two
  Trace open_;                                          // trace of the open pass
  std::map<int, std::shared_ptr<const Trace>> traces_;  // traces of the ended passes, by pass number

  std::mutex measuring_;                   // one Update at a time
  mutable rt::InheritingMutex mutex_;      // guards the members below, for the frames' and pages' threads
  std::shared_ptr<const Input> newest_;    // the newest input, which is to be scored
  std::shared_ptr<const Input> measured_;  // the last input that was scored
  ScoreSoFar score_;                       // score of measured_
};

}  // namespace osteon::session
