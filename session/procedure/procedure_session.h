#pragma once

#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "base/inheriting_mutex.h"
#include "control/loop/servo_loop.h"
#include "procedure/plan/surgical_plan.h"
#include "session/procedure/live_score.h"
#include "session/procedure/load_step.h"
#include "session/procedure/pass_detector.h"
#include "session/procedure/procedure_panel.h"
#include "session/procedure/procedure_tools.h"
#include "session/procedure/scripted_changes.h"
#include "session/procedure/session_file.h"
#include "session/procedure/session_request.h"
#include "session/procedure/session_writer.h"
#include "session/run/frame_runner.h"
#include "simulation/bone/bone.h"
#include "simulation/bone/scene_events.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/removal/cut_metrics.h"
#include "simulation/solids/solid.h"
#include "simulation/tools/tool.h"

namespace osteon::session {

/// The gap to bone that every ball of a tool must have before motion resumes after a change of tool or an
/// undo.
inline constexpr double kClearToResume_m = 0.5e-3;

/// The parts from which a procedure's session is made.
struct ProcedureParams {
  std::filesystem::path folder;
  procedure::SurgicalPlan plan;
  SessionFile file;                  ///< a new session without segments, or the session that is resumed
  std::vector<ProcedureTool> tools;  ///< one for each of file.diameters_mm
  int tool{0};                       ///< index of the tool in use at the start
  std::string recording;             ///< name of this run's recording in the folder
  const simulation::Bone* bone{nullptr};
  const simulation::Solid* solid{nullptr};  ///< the bone's solid; null: not known
  simulation::SceneEventParams events;      ///< limits of the cell's scene
  Pose X_WG{Pose::Identity()};
  Pose X_GC{Pose::Identity()};  ///< planned cup: origin at its centre, +z along its axis
  /// Makes the engine for a tool.
  std::function<tl::expected<std::unique_ptr<simulation::CuttingEngine>, std::string>(
      const simulation::Tool&)>
      make_engine;
  bool confirm_size{false};  ///< a person changes the physical tool, and must confirm its size
  /// The arm is in its own impedance control: a person must also confirm the load set in its controller.
  bool confirm_load{false};
  double period_s{1e-3};                        ///< the loop's period; the sensor is read once a period
  bool scripted{false};                         ///< a script presses the buttons (ScriptedChanges)
  ScriptedChanges::Heights scripted_heights{};  ///< heights at which the script presses them
  bool wall_time{false};                        ///< states are written on a thread of their own
  std::optional<procedure::Rubric> rubric{};    ///< for the score on the console; absent: no score is shown
  std::string without_rubric{};                 ///< why the rubric is absent
  std::optional<simulation::SceneEventParams> plan_events{};  ///< of the plan's scene; absent: `events`
};

/// The session of a procedure while its cell runs: passes, saved states, undo, change of tool.
///
///     osteon tell, console ──Ask──▶ [request] ◀─BeforeFrame── frames' thread: engine, states, passes
///                                       └─Poll──▶ ServoLoop::RequestTool, RequestPause, RequestResume
///
/// **Change of tool.** It is requested while the loop is paused. (1) The frames' thread checks that every
/// ball of the new tool, at the present pose, would be 0.5 mm clear of bone. (2) The loop takes the new
/// tool's prepared parameters; the joints stay. (3) The command then names the new tool, and the frames'
/// thread continues from the last saved state with an engine for that tool. Nothing moves until a resume,
/// before which the clearance is checked again.
///
/// No request moves the arm, except a resume, which asks the loop as `osteon resume` does.
class ProcedureSession final : public FrameObserver {
 public:
  explicit ProcedureSession(ProcedureParams params);

  /// Puts the engine into the session's last saved state, and opens a segment. Call it before the run.
  /// @returns an error if that state cannot be read or restored, or session.json cannot be written.
  [[nodiscard]] tl::expected<void, std::string> Begin(simulation::CuttingEngine& engine);

  void BeforeFrame(const simulation::ToolCommand& command, FrameRunner& runner) override;
  void AfterFrame(const simulation::ToolCommand& command, const simulation::FrameRecord& record) override;
  /// Call it after the last frame: ends the open pass and the segment, and writes everything.
  /// @returns what could not be written; empty: nothing
  [[nodiscard]] std::string End(const simulation::CuttingEngine& engine);

  /// Takes each recorded tick, for the sensor's reading at rest. Call it from one thread only.
  void OnTick(const control::TickRecord& tick);
  /// Passes the accepted requests to the loop. Called by the thread that passes an operator's requests to the
  /// loop.
  void Poll(control::ServoLoop& loop);
  /// Requests a resume for the operator; a later Poll passes it to the loop, once the tool is clear. Any
  /// thread.
  void RequestResume() { resume_asked_.store(true); }

  /// Makes a request, and waits up to 0.7 s for the answer. Do not call it from the frames' thread.
  [[nodiscard]] SessionAnswer Ask(const SessionRequest& request);
  /// Makes a request without waiting; `answered` is called on the frames' thread.
  /// @returns false if another request is open, or the run is over
  bool Post(const SessionRequest& request, std::function<void(const SessionAnswer&)> answered);

  [[nodiscard]] const std::vector<ProcedureTool>& tools() const { return params_.tools; }
  [[nodiscard]] int first_tool() const { return params_.tool; }
  /// The tool of the newest frame. Any thread.
  [[nodiscard]] int tool_in_use() const { return framed_tool_.load(); }
  [[nodiscard]] const procedure::SurgicalPlan& plan() const { return params_.plan; }
  /// The session as it is now. Any thread.
  [[nodiscard]] SessionFile File() const;
  [[nodiscard]] const std::filesystem::path& folder() const { return params_.folder; }
  /// Name of this run's recording in the folder.
  [[nodiscard]] const std::string& recording() const { return params_.recording; }
  /// The console's messages of the plan and of the session's state (ProcedurePanel). Any thread.
  [[nodiscard]] const std::string& PlanJson() const { return panel_.PlanJson(); }
  [[nodiscard]] std::string PanelJson() const;
  /// The console's message of the score so far (LiveScore). Any thread but the frames'. In virtual time this
  /// call measures the bone; in wall time the writer's thread does.
  [[nodiscard]] std::string ScoreJson();
  /// Whether a person has finished the session: all is saved, and the run is to end. Any thread.
  [[nodiscard]] bool finished() const { return finished_.load(); }
  /// Thinnest wall that any tool but the one in use at the start has left [m]; nothing: no wall was seen.
  [[nodiscard]] std::optional<double> min_wall_m() const;

 private:
  // The request that is being carried out.
  struct Open {
    SessionRequest request;
    std::function<void(const SessionAnswer&)> answered;
    bool waits_for_loop{false};  // the answer follows once the loop has taken the tool
  };
  // The measurements of one tool. They are kept while other tools are in use.
  struct Watched {
    std::optional<simulation::ApexDepth> depth;
    std::optional<simulation::SceneWatch> watch;
  };

  // Each of the functions that return a SessionAnswer carries out one kind of request, or refuses it.
  void HandleRequest(const simulation::ToolCommand& command, FrameRunner& runner);
  [[nodiscard]] SessionAnswer Resume(const simulation::ToolCommand& command, const FrameRunner& runner);
  void HandleResume(const simulation::ToolCommand& command, FrameRunner& runner);
  void PressButtons(const simulation::ToolCommand& command);
  [[nodiscard]] SessionAnswer StartChange(const SessionRequest& request,
                                          const simulation::ToolCommand& command, FrameRunner& runner,
                                          bool& waits);
  [[nodiscard]] SessionAnswer Undo(const simulation::ToolCommand& command, FrameRunner& runner);
  [[nodiscard]] SessionAnswer SetGuidance(double gain);
  [[nodiscard]] SessionAnswer Save(const simulation::ToolCommand& command, FrameRunner& runner);
  [[nodiscard]] SessionAnswer Finish(const SessionRequest& request, const simulation::ToolCommand& command,
                                     FrameRunner& runner);
  void RenewScore();
  // CheckLoad and RetractFirst return why a request is refused; empty: it is permitted.
  [[nodiscard]] std::string CheckLoad(int tool, const simulation::ToolCommand& command) const;
  void SwitchTool(const simulation::ToolCommand& command, FrameRunner& runner);
  [[nodiscard]] std::vector<MissedChange> MissedChanges() const;
  void EndOpenPass(const simulation::CuttingEngine& engine, rt::Nanoseconds stamp);
  void EndPass(const simulation::CuttingEngine& engine, rt::Nanoseconds stamp);
  void CloseSegment(rt::Nanoseconds end);
  void OpenSegment(rt::Nanoseconds begin);
  [[nodiscard]] std::string RetractFirst(const simulation::CarvedState& state, int tool,
                                         const Pose& X_GT) const;
  void Answer(const SessionAnswer& answer);
  void WriteFile();

  ProcedureParams params_;
  ProcedurePanel panel_;
  LiveScore score_;
  SessionWriter writer_;  // its thread uses the score

  // used by the frames' thread only
  int tool_{0};
  PassDetector pass_;
  ScriptedChanges script_;
  std::shared_ptr<const simulation::CarvedState> uncut_, saved_;  // saved_: the last saved state that was not
                                                                  // undone
  std::string saved_name_, saved_hash_;
  int states_{0};                  // number in the name of the last state's file
  bool changed_{false};            // tool or bone changed in this pause, so a resume is checked
  bool end_pass_{false};           // the pass has ended with the last frame
  std::optional<double> to_go_m_;  // smallest height over the planned place in the open pass
  rt::Nanoseconds last_stamp_{0};
  std::map<int, Watched> watched_;  // by tool index; without the tool in use at the start
  std::string error_;               // why a tool's engine could not be made; empty: all were made

  std::atomic<int> wanted_tool_{-1};                // tool for the next Poll; -1: none
  std::atomic<int> framed_tool_{0};                 // tool of the newest frame
  std::atomic<double> wanted_gain_{-1.0};           // guidance gain for the next Poll; negative: none
  double guidance_gain_{0.0};                       // the gain in force; guarded by mutex_
  std::atomic<bool> pause_{false}, resume_{false};  // requests for the next Poll
  std::atomic<bool> resume_asked_{false};           // set by RequestResume, not checked yet
  std::atomic<bool> finished_{false};
  std::atomic<bool> in_pass_{false};             // a pass was open in the newest frame
  std::atomic<rt::Nanoseconds> frame_stamp_{0};  // stamp of the newest frame's pose

  mutable rt::InheritingMutex mutex_;  // guards the following, for the frames' and pages' threads
  PausedReadings readings_;
  std::optional<Open> open_;
  bool over_{false};  // no further frame comes
  SessionFile file_;
};

}  // namespace osteon::session
