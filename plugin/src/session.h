#pragma once

#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/latest_value.h"
#include "control/coupling/virtual_coupling.h"
#include "plugin/src/bone_source.h"
#include "plugin/src/compliance_levels.h"
#include "plugin/src/surface_mailbox.h"
#include "procedure/assessment/assessment.h"
#include "safety/limits.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/removal/cut_metrics.h"
#include "simulation/surface/surface_thread.h"

namespace osteon::plugin {

/// Content of an OsteonSession: engine, coupling, surface, events.
///
///     SetToolPose ──LatestValue──▶ engine's thread ──LatestValue──▶ Evaluate
///          ▲                             └──ring──▶ surface's thread ──▶ SurfaceMailbox
///          └────LatestValue: Deflected, if compliance is on──────────────┘ (Evaluate)
///
/// SetToolPose's thread writes the commands, and the engine's thread reads them. The engine's thread writes
/// the models (in lockstep: Step's thread), and Evaluate's thread reads them. All other data are guarded by
/// engine_mutex_, which the engine's thread locks while it computes a frame.
class Session {
 public:
  /// @throws Failure, or another exception that Guarded() turns into a code.
  Session(std::shared_ptr<const BoneSource> bone, std::shared_ptr<const ToolSource> tool,
          const OsteonSettings& settings);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Passes a pose to the engine's thread. @param pose  one for which IsUsable is true
  void SetToolPose(const OsteonPose& pose, double spindle_rad_per_s) noexcept;
  /// @param pose, twist  checked to be usable  @returns the wrench on the tool, within the limits
  [[nodiscard]] Wrench Evaluate(const OsteonPose& pose, const OsteonTwist& twist) noexcept;

  void Step(const Pose& X_GT, double spindle_rad_per_s, double dt_s);
  [[nodiscard]] OsteonFigures Figures();
  [[nodiscard]] std::optional<OsteonEvent> NextEvent();

  /// Sets the compliance of tool, tissue and mount (osteon_session_set_compliance). @param params  null: no
  /// compliance
  void SetCompliance(const OsteonComplianceParams* params);
  [[nodiscard]] OsteonDeflection Deflection();

  /// Sets the function that receives log messages (osteon_session_set_log).
  void SetLog(OsteonLogCallback callback, void* user);

  void ChangeTool(std::shared_ptr<const ToolSource> tool, const Pose& X_GT);
  void Mark();
  void Undo(const Pose& X_GT);
  void Save(const std::string& file);
  void Restore(const std::string& file, const Pose& X_GT);

  /// Compares the bone in its present state with a plan. The result has no figures of time, path and hand.
  /// @throws Failure if the plan is for another bone.
  [[nodiscard]] procedure::Assessment Assess(const procedure::SurgicalPlan& plan);

  /// The newest meshes of the surface. @throws Failure if the session has no surface.
  [[nodiscard]] const SurfaceMailbox& mailbox() const;
  void WaitForSurface();
  [[nodiscard]] OsteonSurfaceInfo ExportSurface(const std::string& file);

  [[nodiscard]] bool is_lockstep() const noexcept { return is_lockstep_; }
  [[nodiscard]] const std::string& engine_text() const noexcept { return engine_text_; }
  /// Whether this process is a forked child of the one that made the session.
  [[nodiscard]] bool is_forked() const noexcept { return getpid() != process_; }

 private:
  /// A state of the carved bone that the session can return to.
  struct Saved {
    simulation::CarvedState state;
    std::optional<surface::BrickField> swept;
    procedure::ReamedAxis axis;
    std::optional<double> min_wall_m;
  };
  /// Locks the engine between two frames. The engine's thread does not take the lock while another thread
  /// waits for it.
  class EngineLock;

  /// Runs in the engine's thread: computes a frame for each new pose until stop_ is set.
  void Loop();
  /// Computes one frame and passes it to Evaluate, the surface, the events and the log. Computes no frame as
  /// long as the first pose is in bone. Call it under the engine's lock.
  void ComputeFrame(const simulation::ToolCommand& command, double dt_s);
  /// Thickness of the thinnest wall that any tool has left. Call it under the engine's lock.
  [[nodiscard]] std::optional<double> MinWall() const;
  /// Returns the pose for the engine: the pose of the bent tool's head relative to the bone on its mount.
  /// Called by the thread of SetToolPose or of Step.
  [[nodiscard]] Pose InBone(const Pose& X_GT) noexcept;
  using Levels = const control::Compliance*;  // the compliant parts, at rest; null: no compliance
  /// Makes the requested compliance for this tool. Call it under the engine's lock.
  /// @throws Failure as MakeCompliance.
  [[nodiscard]] Levels LevelsFor(const ToolSource& tool);
  /// Passes compliance to Evaluate; the next call of Evaluate starts with it from rest. Call it under the
  /// engine's lock.
  void UseLevels(Levels levels) noexcept;
  /// @throws Failure if the engine computes no frames: it has failed, or the first pose is in bone.
  void CheckDevice() const;
  /// Passes a message to the caller's log function. Call it under the engine's lock. Exceptions of the log
  /// function are caught.
  void Log(OsteonLogLevel level, const std::string& text) const;
  [[nodiscard]] std::string InBoneText() const;
  [[nodiscard]] std::unique_ptr<simulation::CuttingEngine> MakeEngine(const ToolSource& tool) const;
  /// Calls SurfaceThread::Apply. Call it only if the session has a surface.
  /// @throws Failure if the surface's thread has failed; otherwise the exceptions of `change`.
  void ApplyToSurface(const std::function<void(surface::CarvedField&, surface::ToolSweep&)>& change);
  /// Waits until the surface's thread has taken all frames. Call it before locking the engine: otherwise
  /// frames would be delayed while a large mesh is sampled for the first time.
  void AwaitField();
  /// The surface's grid, which does not change. Call it only if the session has a surface.
  [[nodiscard]] surface::BrickLayout SurfaceLayout();
  /// Copies the present state. Call it under the engine's lock.
  [[nodiscard]] Saved Remember();
  /// Continues from a saved state with `tool` at X_GT. Call it under the engine's lock. If it throws, nothing
  /// has changed.
  void Continue(std::shared_ptr<const ToolSource> tool, Saved saved, const Pose& X_GT);

  const std::shared_ptr<const BoneSource> bone_;
  const bool is_lockstep_;
  const pid_t process_;  // process that made the session
  const safety::WrenchLimiter limiter_;
  control::CouplingParams coupling_;
  simulation::CuttingParams cutting_;
  std::string engine_text_;
  std::string engine_name_, device_;  // as in osteon::session::EngineChoice

  rt::LatestValue<simulation::ToolCommand> commands_;
  rt::LatestValue<simulation::ContactModel> models_;
  std::atomic<bool> spindle_on_{false};
  std::atomic<rt::Nanoseconds> clock_{1};     // present time in lockstep
  std::atomic<std::uint32_t> beginnings_{0};  // number of changes of bone, tool or compliance
  // used only by the thread of Evaluate
  control::CouplingState coupling_state_;
  std::optional<control::Compliance> compliance_;
  std::uint32_t begun_{0};  // value of beginnings_ at which Evaluate last started from rest
  // levels_: compliance passed to Evaluate; for_poses_, for_figures_: displacements passed from Evaluate
  rt::LatestValue<Levels> levels_{nullptr};
  rt::LatestValue<Deflected> for_poses_, for_figures_;

  std::mutex engine_mutex_;
  std::atomic<int> waiting_{0};  // threads that wait for an EngineLock or hold one
  // guarded by engine_mutex_:
  std::shared_ptr<const ToolSource> tool_;
  std::unique_ptr<simulation::CuttingEngine> engine_;
  std::optional<simulation::ApexDepth> depth_;
  std::optional<simulation::SceneWatch> watch_;
  simulation::ContactModel newest_;
  procedure::ReamedAxis axis_;  // axis of the tool that cut last
  // axis_ is that of an earlier tool, because the tool in use has cut nothing yet
  bool axis_of_tool_before_{false};
  std::optional<double> min_wall_m_;  // thinnest wall that earlier tools have left
  double frame_time_s_{0.0};
  double in_bone_at_start_m_{0.0};  // depth of the tool in bone at the first pose; 0: that pose was free
  rt::Nanoseconds last_stamp_{0};   // stamp of the newest frame's pose
  rt::Nanoseconds continued_{0};    // time of the last change of tool or bone
  std::deque<OsteonEvent> events_;
  std::deque<Saved> marks_;
  std::optional<OsteonComplianceParams> asked_;  // the requested compliance
  // every compliance made so far, because Evaluate may still read it until the session ends
  std::vector<std::unique_ptr<const control::Compliance>> all_levels_;
  OsteonLogCallback log_{nullptr};
  void* log_user_{nullptr};
  bool has_logged_failure_{false};
  std::string error_;  // text of the exception that ended the engine's thread

  SurfaceMailbox mailbox_;
  std::unique_ptr<surface::SurfaceThread> surface_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace osteon::plugin
