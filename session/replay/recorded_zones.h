#pragma once

#include <memory>
#include <vector>

#include <tl/expected.hpp>

#include "io/recording/messages.h"
#include "session/run/adaptive_resolution.h"
#include "simulation/engine/frame_record.h"

namespace osteon::session {

/// Repeats the coarsening of zones while a recording's frames are cut again. Like AdaptiveResolution in the
/// run, it packs the coarser zones, carves them along the proxy's path so far, and provides the engine that
/// continues.
class RecordedZones {
 public:
  /// @param setup    packed as recorded, with its plan if there are changes; must outlive this object
  /// @param changes  the recording's events with a packing, in their order
  RecordedZones(const CellSetup& setup, std::vector<io::RecordedEvent> changes, EngineChoice engine);

  /// Takes each recorded frame after the engine `now` has cut it again.
  /// @returns the engine that replaces `now`; null: continue with `now`. The error says why the coarser zones
  /// cannot be made.
  [[nodiscard]] tl::expected<std::unique_ptr<simulation::CuttingEngine>, std::string> Add(
      const simulation::FrameRecord& frame, const simulation::CuttingEngine& now);

  /// The changes so far, in the form in which the run reported them.
  [[nodiscard]] std::vector<Rezoned>& rezoned() { return rezoned_; }

 private:
  // Packs and carves the coarser zones of a change that followed the frame `last`, and returns their engine.
  [[nodiscard]] tl::expected<std::unique_ptr<simulation::CuttingEngine>, std::string> MakeZones(
      const io::RecordedEvent& change, const simulation::FrameRecord& last,
      const simulation::CuttingEngine& now);

  const CellSetup& setup_;
  std::vector<io::RecordedEvent> changes_;
  EngineChoice engine_;
  Pose X_GW_;
  std::optional<simulation::ProxyTrail> trail_;  // absent if there are no changes
  std::vector<Rezoned> rezoned_;
};

}  // namespace osteon::session
