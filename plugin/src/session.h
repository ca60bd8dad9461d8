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
///          └────LatestValue: Deflected, where something gives way────────┘ (Evaluate)
///
/// SetToolPose's thread writes the commands, and the engine's thread reads them. The engine's thread writes
/// the models (in lockstep: Step's thread), and Evaluate's thread reads them. All other data are under
/// engine_mutex_, which the engine's thread holds while it computes a frame.
class Session {
 public:
  /// @throws Failure, or another exception that Guarded() turns into a code.
  Session(std::shared_ptr<const BoneSource> bone, std::shared_ptr<const ToolSource> tool,
          const OsteonSettings& settings);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// @param pose  usable
  void SetToolPose(const OsteonPose& pose, double spindle_rad_per_s) noexcept;
  /// @param pose, twist  usable. @returns the limited wrench.
  [[nodiscard]] Wrench Evaluate(const OsteonPose& pose, const OsteonTwist& twist) noexcept;

  void Step(const Pose& X_GT, double spindle_rad_per_s, double dt_s);
  [[nodiscard]] OsteonFigures Figures();
  [[nodiscard]] std::optional<OsteonEvent> NextEvent();

  /// As osteon_session_set_compliance says. @param params  null: nothing gives way
  void SetCompliance(const OsteonComplianceParams* params);
  [[nodiscard]] OsteonDeflection Deflection();

  /// As osteon_session_set_log says.
  void SetLog(OsteonLogCallback callback, void* user);

  void ChangeTool(std::shared_ptr<const ToolSource> tool, const Pose& X_GT);
  void Mark();
  void Undo(const Pose& X_GT);
  void Save(const std::string& file);
  void Restore(const std::string& file, const Pose& X_GT);

  /// Compares the bone as it is with a plan. The result has no figures of the process.
  /// @throws Failure if the plan is for another bone.
  [[nodiscard]] procedure::Assessment Assess(const procedure::SurgicalPlan& plan);

  /// @throws Failure if the session has no surface.
  [[nodiscard]] const SurfaceMailbox& mailbox() const;
  void WaitForSurface();
  [[nodiscard]] OsteonSurfaceInfo ExportSurface(const std::string& file);

  [[nodiscard]] bool is_lockstep() const noexcept { return is_lockstep_; }
  [[nodiscard]] const std::string& engine_text() const noexcept { return engine_text_; }
  /// Whether this process is a forked child of the one that made the session.
  [[nodiscard]] bool is_forked() const noexcept { return getpid() != process_; }

 private:
  /// A state of the carved bone, to return to.
  struct Saved {
    simulation::CarvedState state;
    std::optional<surface::BrickField> swept;
    procedure::ReamedAxis axis;
    std::optional<double> min_wall_m;
  };
  /// Locks the engine between two frames: the engine's thread leaves the lock free while anybody waits for
  /// it.
  class EngineLock;

  /// The engine's thread: computes a frame for each new pose until stop_.
  void Loop();
  /// Computes one frame and hands it to Evaluate, the surface, the events and the log. Computes none while
  /// the first pose is in bone. Under the engine's lock.
  void ComputeFrame(const simulation::ToolCommand& command, double dt_s);
  /// Thinnest wall that any tool has left. Under the engine's lock.
  [[nodiscard]] std::optional<double> MinWall() const;
  /// The pose to give to the engine: that of the bent head, relative to the bone on its mount. Called by the
  /// thread of SetToolPose or of Step.
  [[nodiscard]] Pose InBone(const Pose& X_GT) noexcept;
  using Levels = const control::Compliance*;  // the parts that give way, at rest; null: nothing gives way
  /// Makes the requested levels for this tool. Under the engine's lock.
  /// @throws Failure as MakeCompliance.
  [[nodiscard]] Levels LevelsFor(const ToolSource& tool);
  /// Hands levels to Evaluate, whose next call starts from rest with them. Under the engine's lock.
  void UseLevels(Levels levels) noexcept;
  /// @throws Failure if the engine computes no frames: it has failed, or the first pose is in bone.
  void CheckDevice() const;
  /// Under the engine's lock. Exceptions of the callback end here.
  void Log(OsteonLogLevel level, const std::string& text) const;
  [[nodiscard]] std::string InBoneText() const;
  [[nodiscard]] std::unique_ptr<simulation::CuttingEngine> MakeEngine(const ToolSource& tool) const;
  /// Calls SurfaceThread::Apply. Only with a surface.
  /// @throws Failure if the surface's thread has failed; otherwise the exceptions of `change`.
  void ApplyToSurface(const std::function<void(surface::CarvedField&, surface::ToolWays&)>& change);
  /// Waits until the surface has all frames. Call it before taking the engine's lock, so that no frame waits
  /// for the start of a large mesh.
  void AwaitField();
  /// The surface's grid, which does not change. Only with a surface.
  [[nodiscard]] surface::BrickLayout SurfaceLayout();
  /// Copies the present state. Under the engine's lock.
  [[nodiscard]] Saved Remember();
  /// Continues at a saved state with `tool` at X_GT. Under the engine's lock. An exception changes nothing.
  void Continue(std::shared_ptr<const ToolSource> tool, Saved saved, const Pose& X_GT);

  const std::shared_ptr<const BoneSource> bone_;
  const bool is_lockstep_;
  const pid_t process_;  // that made the session
  const safety::WrenchLimiter limiter_;
  control::CouplingParams coupling_;
  simulation::CuttingParams cutting_;
  std::string engine_text_;
  std::string engine_name_, device_;  // as osteon::session::EngineChoice has them

  rt::LatestValue<simulation::ToolCommand> commands_;
  rt::LatestValue<simulation::ContactModel> models_;
  std::atomic<bool> spindle_on_{false};
  std::atomic<rt::Nanoseconds> clock_{1};     // the time in lockstep
  std::atomic<std::uint32_t> beginnings_{0};  // counts changes of the bone, the tool and the levels
  // of the thread of Evaluate
  control::CouplingState coupling_state_;
  std::optional<control::Compliance> compliance_;
  std::uint32_t begun_{0};  // value of beginnings_ that Evaluate works with
  // what gives way: handed to Evaluate, and from it
  rt::LatestValue<Levels> levels_{nullptr};
  rt::LatestValue<Deflected> for_poses_, for_figures_;

  std::mutex engine_mutex_;
  std::atomic<int> waiting_{0};  // threads that wait for an EngineLock or hold one
  // under engine_mutex_
  std::shared_ptr<const ToolSource> tool_;
  std::unique_ptr<simulation::CuttingEngine> engine_;
  std::optional<simulation::ApexDepth> depth_;
  std::optional<simulation::SceneWatch> watch_;
  simulation::ContactModel newest_;
  procedure::ReamedAxis axis_;        // axis of the tool that cut last
  bool axis_of_tool_before_{false};   // the tool in use has cut nothing yet
  std::optional<double> min_wall_m_;  // thinnest wall that earlier tools have left
  double frame_time_s_{0.0};
  double in_bone_at_start_m_{0.0};  // depth of the tool in bone at a first pose that is not free
  rt::Nanoseconds last_stamp_{0};   // of the newest frame's pose
  rt::Nanoseconds continued_{0};    // time of the last change of tool or bone
  std::deque<OsteonEvent> events_;
  std::deque<Saved> marks_;
  std::optional<OsteonComplianceParams> asked_;  // the requested compliance
  // Evaluate may read each of them until the session ends
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
