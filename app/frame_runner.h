#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/zone_governor.h"
#include "io/recording/recorder.h"
#include "simulation/cutting_engine.h"
#include "simulation/frame_record.h"
#include "simulation/metrics/cut_metrics.h"
#include "simulation/scene_events.h"

namespace osteon::app {

/// One frame after the other, and what is recorded of each. Used in both clocks.
class FrameRunner {
 public:
  /// @param watch  looks at every frame's proxy
  /// @param governor  coarsens zones where frames take too long; null: nobody does
  /// @param dt_limit_s  the longest time that a single frame may cut for: what is missed in a stall is not
  /// made up for
  FrameRunner(simulation::CuttingEngine& engine, const simulation::ApexDepth& depth,
              simulation::SceneWatch& watch, const Pose& X_WG, ZoneGovernor* governor = nullptr,
              double dt_limit_s = 0.1);

  /// Steps the engine to the command. The first command is the free pose that everything starts from.
  [[nodiscard]] simulation::FrameRecord Run(const simulation::ToolCommand& command);

  /// Shows the governor a frame that Run has made, and goes on with its coarser zones where they are ready.
  /// @param took_us  the frame
  void Govern(const simulation::FrameRecord& record, double took_us);

  /// After the last frame: ends the governor. Waits until a packing in the making can be given up, which may
  /// take seconds.
  void EndGoverning();

  /// @param notice  told of coarser zones, on the thread of the frames; may be empty
  void TellOf(std::function<void(const std::string&)> notice) { notice_ = std::move(notice); }

  /// What makes the frames now.
  [[nodiscard]] const simulation::CuttingEngine& engine() const { return *engine_; }
  /// Zones that were coarsened, in their order. Once there is no frame to come.
  [[nodiscard]] std::vector<Rezoned> TakeRezoned() { return std::move(rezoned_); }

  /// Records the events of the frames since the last call, at `stamp`; their own stamp becomes this.
  void RecordEvents(io::Recorder& recorder, rt::Nanoseconds stamp);
  /// All events so far that were recorded. Once the simulation's thread has ended.
  [[nodiscard]] const std::vector<simulation::SceneEvent>& events() const { return events_; }

 private:
  void Say(std::string text);

  simulation::CuttingEngine* engine_;
  std::unique_ptr<simulation::CuttingEngine> rezoned_engine_;  // what engine_ is from the first change on
  const simulation::ApexDepth& depth_;
  simulation::SceneWatch& watch_;
  Pose X_GW_;
  ZoneGovernor* governor_;
  double dt_limit_s_;
  std::vector<Rezoned> rezoned_;
  std::vector<std::string> new_texts_;
  std::function<void(const std::string&)> notice_;
  rt::Nanoseconds last_stamp_{0};
  std::optional<double> deepest_m_;
  std::vector<simulation::SceneEvent> new_events_, events_;
};

}  // namespace osteon::app
