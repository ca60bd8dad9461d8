#include "session/replay/recorded_zones.h"

#include <stdexcept>
#include <utility>

#include "session/planning/recorded_packing.h"

namespace osteon::session {

RecordedZones::RecordedZones(const CellSetup& setup, std::vector<io::RecordedEvent> changes,
                             EngineChoice engine)
    : setup_(setup), changes_(std::move(changes)), engine_(std::move(engine)), X_GW_(setup.X_WG.inverse()) {
  if (!setup.planned) changes_.clear();
  if (!changes_.empty()) trail_.emplace(MakeProxyTrail(setup));
}

tl::expected<std::unique_ptr<simulation::CuttingEngine>, std::string> RecordedZones::Add(
    const simulation::FrameRecord& frame, const simulation::CuttingEngine& now) {
  if (rezoned_.size() == changes_.size() || frame.model.status != simulation::EngineStatus::kOk)
    return nullptr;
  trail_->Add(X_GW_ * Pose(frame.model.X_WP));
  const io::RecordedEvent& change = changes_[rezoned_.size()];
  if (frame.model.frame < change.after_frame) return nullptr;
  return MakeZones(change, frame, now);
}

tl::expected<std::unique_ptr<simulation::CuttingEngine>, std::string> RecordedZones::MakeZones(
    const io::RecordedEvent& change, const simulation::FrameRecord& last,
    const simulation::CuttingEngine& now) {
  const auto level = LevelOf(*change.packing);
  if (!level) return tl::make_unexpected(level.error());
  try {
    Rezoned rezoned{.zones = {.level = *level,
                              .promised_m = change.packing->promised_error_m,
                              .frame_us = change.packing->expected_frame_us},
                    .seen_us = change.packing->seen_frame_us,
                    .bone = PackCoarser(setup_, *level),
                    .stamp = last.stamp};
    if (std::string other = DescribeOtherBalls(*change.packing, rezoned.bone); !other.empty())
      return tl::make_unexpected(std::move(other));
    auto engines = MakeCoarserEngines(setup_, *level, rezoned.bone, engine_);
    if (!engines) return tl::make_unexpected(engines.error());
    if (!simulation::CarveTrail(*engines->carver, trail_->places()))
      return tl::make_unexpected("the coarser zones: a frame of the carving was refused");
    engines->engine->Restore(simulation::MergeCarvedStates(engines->carver->Snapshot(), now.Snapshot()));
    rezoned_.push_back(std::move(rezoned));
    return std::move(engines->engine);
  } catch (const std::invalid_argument& error) {
    return tl::make_unexpected("the coarser zones: " + std::string(error.what()));
  }
}

}  // namespace osteon::session
