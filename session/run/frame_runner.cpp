#include "session/run/frame_runner.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "session/planning/recorded_packing.h"

namespace osteon::session {

FrameRunner::FrameRunner(simulation::CuttingEngine& engine, const simulation::ApexDepth& depth,
                         simulation::SceneWatch& watch, const Pose& X_WG,
                         AdaptiveResolution* adaptive_resolution, double dt_limit_s)
    : engine_(&engine),
      depth_(&depth),
      watch_(&watch),
      X_GW_(X_WG.inverse()),
      adaptive_resolution_(adaptive_resolution),
      dt_limit_s_(dt_limit_s) {}

simulation::FrameRecord FrameRunner::Run(const simulation::ToolCommand& command) {
  if (observer_) observer_->BeforeFrame(command, *this);
  const double dt_s = last_stamp_ == 0 ? 0.0 : rt::ToSeconds(command.stamp - last_stamp_);
  last_stamp_ = command.stamp;
  const simulation::FrameRecord record =
      Observe(engine_->Step({.X_WT = command.X_WT,
                             .spindle_rad_per_s = command.spindle_rad_per_s,
                             .dt_s = std::clamp(dt_s, 0.0, dt_limit_s_),
                             .stamp = command.stamp}),
              command.spindle_rad_per_s, command.stamp);
  if (observer_) observer_->AfterFrame(command, record);
  return record;
}

simulation::FrameRecord FrameRunner::Observe(const simulation::ContactModel& model, double spindle_rad_per_s,
                                             rt::Nanoseconds stamp) {
  simulation::FrameRecord record;
  record.model = model;
  if (surface_) (void)surface_->Push(surface::MakeToolFrame(record.model, spindle_rad_per_s));
  if (record.model.status == simulation::EngineStatus::kOk) {
    const Pose X_GP = X_GW_ * Pose(record.model.X_WP);
    deepest_m_ = std::max(deepest_m_.value_or(-1.0), depth_->DepthAt(X_GP));
    for (simulation::SceneEvent& event : watch_->Step(X_GP, record.model.removed_volume_m3, stamp))
      new_events_.push_back(std::move(event));
  }
  record.cup_depth_m = deepest_m_.value_or(0.0);
  return record;
}

void FrameRunner::AdaptResolution(const simulation::FrameRecord& record, double took_us) {
  if (!adaptive_resolution_ || record.model.status != simulation::EngineStatus::kOk) return;
  adaptive_resolution_->ObserveFrame(record, took_us);
  if (auto made = adaptive_resolution_->TakeReplacement(*engine_)) {
    own_engine_ = std::move(made->engine);
    engine_ = own_engine_.get();
    made->rezoned.stamp = record.stamp;
    Say(RezonedText(made->rezoned));
    new_texts_.back().packing = MakePackingRecord(made->rezoned);
    new_texts_.back().after_frame = record.model.frame;
    rezoned_.push_back(std::move(made->rezoned));
  }
  Say(adaptive_resolution_->TakeNotice());
}

void FrameRunner::ReplaceEngine(std::unique_ptr<simulation::CuttingEngine> engine,
                                const simulation::ApexDepth& depth, simulation::SceneWatch& watch) {
  own_engine_ = std::move(engine);
  engine_ = own_engine_.get();
  depth_ = &depth;
  watch_ = &watch;
}

void FrameRunner::EndAdaptiveResolution() {
  if (!adaptive_resolution_) return;
  adaptive_resolution_->End();
  Say(adaptive_resolution_->TakeNotice());
}

void FrameRunner::Say(std::string text) {
  if (text.empty()) return;
  if (notice_) notice_(text);
  new_texts_.push_back({.text = std::move(text)});
}

void FrameRunner::RecordEvents(io::Recorder& recorder, rt::Nanoseconds stamp) {
  for (io::RecordedEvent& event : new_texts_) {
    event.stamp = stamp;
    recorder.PushEvent(std::move(event));
  }
  new_texts_.clear();
  for (simulation::SceneEvent& event : new_events_) {
    event.stamp = stamp;
    const Vector3 p_mm = 1e3 * Vector3(event.p_G_m);
    recorder.PushEvent(stamp, fmt::format("{}: {:.3f} mm, at ({:.3f}, {:.3f}, {:.3f}) mm of the bone",
                                          event.name, event.value * 1e3, p_mm.x(), p_mm.y(), p_mm.z()));
    events_.push_back(std::move(event));
  }
  new_events_.clear();
}

}  // namespace osteon::session
