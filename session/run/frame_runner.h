#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/recording/recorder.h"
#include "session/run/adaptive_resolution.h"
#include "simulation/bone/scene_events.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/engine/frame_record.h"
#include "simulation/removal/cut_metrics.h"
#include "simulation/surface/surface_thread.h"

namespace osteon::session {

class FrameRunner;

/// Called before and after each frame, on the frames' thread. It may change engine and tool before the frame.
class FrameObserver {
 public:
  virtual ~FrameObserver() = default;
  virtual void BeforeFrame(const simulation::ToolCommand& command, FrameRunner& runner) = 0;
  virtual void AfterFrame(const simulation::ToolCommand& command, const simulation::FrameRecord& record) = 0;
};

/// Computes one frame after the other and makes the record of each. Used in wall time and in virtual time.
class FrameRunner {
 public:
  /// @param watch  examines every frame's proxy
  /// @param adaptive_resolution  coarsens zones when frames take too long; null: none
  /// @param dt_limit_s  longest time for which a single frame may cut: cutting that was missed during a stall
  /// is not made up
  FrameRunner(simulation::CuttingEngine& engine, const simulation::ApexDepth& depth,
              simulation::SceneWatch& watch, const Pose& X_WG,
              AdaptiveResolution* adaptive_resolution = nullptr, double dt_limit_s = 0.1);

  /// Steps the engine to the command. The first command must be the run's initial pose, which is clear of
  /// bone.
  [[nodiscard]] simulation::FrameRecord Run(const simulation::ToolCommand& command);

  /// Makes the record of a frame that an engine in another process has stepped.
  /// @param stamp  stamp for the frame's events  @param spindle_rad_per_s  spindle speed in the frame's
  /// command
  [[nodiscard]] simulation::FrameRecord Observe(const simulation::ContactModel& model,
                                                double spindle_rad_per_s, rt::Nanoseconds stamp);

  /// Passes a frame made by Run to the adaptive resolution, and switches to its coarser zones once they are
  /// ready.
  /// @param took_us  duration of the frame
  void AdaptResolution(const simulation::FrameRecord& record, double took_us);

  /// Ends the adaptive resolution, after the last frame. If a packing is being made, waits until it can be
  /// abandoned, which may take seconds.
  void EndAdaptiveResolution();

  /// @param notice  called with the text of each event of Say, on the frames' thread; may be empty
  void SetNotice(std::function<void(const std::string&)> notice) { notice_ = std::move(notice); }

  /// @param surface  gets the path of each frame; null: no surface is made. It must outlive the last frame.
  void SetSurface(surface::SurfaceThread* surface) { surface_ = surface; }

  /// @param observer  called for each frame; null: none. It must outlive the last frame.
  void SetObserver(FrameObserver* observer) { observer_ = observer; }
  /// Continues with another engine, which has another tool. The previous engine is no longer used.
  /// @param depth, watch  depth and watch of that tool; they must outlive the last frame
  void ReplaceEngine(std::unique_ptr<simulation::CuttingEngine> engine, const simulation::ApexDepth& depth,
                     simulation::SceneWatch& watch);
  /// Adds an event: the notice is called at once, and the event is recorded with those of the frame.
  void Say(std::string text);

  /// The engine that makes the frames at present.
  [[nodiscard]] const simulation::CuttingEngine& engine() const { return *engine_; }
  [[nodiscard]] simulation::CuttingEngine& engine() { return *engine_; }
  /// The surface that follows the cut; null: none.
  [[nodiscard]] surface::SurfaceThread* surface() { return surface_; }
  /// Returns the coarsened zones, in their order. Call it after the last frame.
  [[nodiscard]] std::vector<Rezoned> TakeRezoned() { return std::move(rezoned_); }

  /// Records the events of the frames since the last call, with `stamp` instead of their own stamps.
  void RecordEvents(io::Recorder& recorder, rt::Nanoseconds stamp);
  /// All events recorded so far. Read it after the simulation's thread has ended.
  [[nodiscard]] const std::vector<simulation::SceneEvent>& events() const { return events_; }

 private:
  simulation::CuttingEngine* engine_;
  // The engine in use after the first change; before, it is the constructor's engine.
  std::unique_ptr<simulation::CuttingEngine> own_engine_;
  const simulation::ApexDepth* depth_;
  simulation::SceneWatch* watch_;
  FrameObserver* observer_{nullptr};
  Pose X_GW_;
  AdaptiveResolution* adaptive_resolution_;
  double dt_limit_s_;
  surface::SurfaceThread* surface_{nullptr};
  std::vector<Rezoned> rezoned_;              // coarsened zones so far
  std::vector<io::RecordedEvent> new_texts_;  // events of Say that are not recorded yet
  std::function<void(const std::string&)> notice_;
  rt::Nanoseconds last_stamp_{0};                            // stamp of the last command
  std::optional<double> deepest_m_;                          // largest depth of the tool's apex so far
  std::vector<simulation::SceneEvent> new_events_, events_;  // new_events_ are not recorded yet
};

}  // namespace osteon::session
