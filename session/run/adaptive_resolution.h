#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "session/planning/planned_cell.h"
#include "simulation/engine/frame_record.h"
#include "simulation/fidelity/recarve.h"

namespace osteon::session {

/// The conditions under which a run's zones are coarsened.
struct AdaptiveResolutionParams {
  double rate_hz{250.0};     ///< frame rate [Hz] that the median frame time must reach
  std::size_t window{200};   ///< number of frames in contact of which the median is taken
  double within_ratio{0.9};  ///< largest ratio of a coarser packing's frame time to the permitted one
  EngineChoice engine;       ///< engine for the coarser packing
  /// Make the new packing in the calling thread, between two frames: for virtual time.
  bool at_once{false};
};

/// A coarser packing that replaced a run's packing.
struct Rezoned {
  CoarserZones zones;
  double seen_us{0.0};       ///< median frame time that led to the change
  simulation::Bone bone;     ///< the coarser bone as packed, before it was carved
  rt::Nanoseconds stamp{0};  ///< stamp of the last frame before the change
};

/// Watches the frames of a planned run. If they keep taking longer than the rate allows, the zones are
/// coarsened: the bone is packed again on a wider lattice of the same kind, carved along the tool's path so
/// far, and exchanged for the old packing between two frames. Stiffness, law and tool stay; the totals of
/// volume, mass and work continue. From then on the coarser packing's larger error applies, also to the
/// surface that was cut before.
///
/// Only the simulation's thread calls it; a packing is made in a thread of its own.
class AdaptiveResolution {
 public:
  /// @param setup  with a timed plan; must outlive this object
  AdaptiveResolution(const CellSetup& setup, const AdaptiveResolutionParams& params);
  ~AdaptiveResolution();
  AdaptiveResolution(const AdaptiveResolution&) = delete;
  AdaptiveResolution& operator=(const AdaptiveResolution&) = delete;

  /// Takes each frame that was not refused. @param took_us  duration of the frame
  void ObserveFrame(const simulation::FrameRecord& record, double took_us);

  /// A coarser packing that is ready, with the engine that continues in it.
  struct Made {
    std::unique_ptr<simulation::CuttingEngine> engine;
    Rezoned rezoned;
  };
  /// Returns the engine that replaces `now` once that engine is ready and carved up to the last observed
  /// frame; before that, returns nothing. Does not wait.
  [[nodiscard]] std::optional<Made> TakeReplacement(const simulation::CuttingEngine& now);

  /// Ends the work after the last frame. If coarser zones are still being made, they are abandoned, with a
  /// notice.
  void End();

  /// Returns the notice since the last call: coarser zones are being made, or why they cannot be made. Empty:
  /// none.
  [[nodiscard]] std::string TakeNotice();

 private:
  struct Making;

  // Returns the median frame time [us] if it is longer than the rate allows; else nothing.
  [[nodiscard]] std::optional<double> SlowMedian(double took_us);
  // Chooses coarser zones, and starts to make them. @param seen_us  median frame time
  void StartCoarsening(double seen_us);
  // Packs the bone, and carves it along the trail. In a thread of its own, unless params_.at_once.
  void PackCoarser(Making& making);
  // Adds a text to the notice.
  void Say(std::string text);

  const CellSetup& setup_;
  AdaptiveResolutionParams params_;
  Pose X_GW_;
  double lever_m_;                  ///< lever of the tool (simulation::ToolLever)
  simulation::PackingLevel level_;  ///< level of the present packing
  std::vector<double> times_us_;    ///< durations of frames in contact; a ring buffer
  std::size_t next_{0};             ///< index in times_us_ for the next frame, modulo the window
  bool ended_{false};               ///< no coarser packing will follow

  std::mutex mutex_;  ///< guards the trail
  simulation::ProxyTrail trail_;
  std::unique_ptr<Making> making_;
  std::thread thread_;
  std::string notice_;  ///< notice for TakeNotice
};

/// Makes the adaptive resolution of a cell with a timed plan; null for any other cell, and if the plan
/// already fell short of the demanded rate, because then no coarser packing reaches it.
[[nodiscard]] std::unique_ptr<AdaptiveResolution> MakeAdaptiveResolution(const CellSetup& setup,
                                                                         const EngineChoice& engine);

/// Makes the trail of a planned cell's proxy, fine enough to carve a coarser packing along it.
[[nodiscard]] simulation::ProxyTrail MakeProxyTrail(const CellSetup& setup);
/// Packs a planned cell's bone on a coarser level. @throws std::invalid_argument if the level cannot be
/// packed
[[nodiscard]] simulation::Bone PackCoarser(const CellSetup& setup, const simulation::PackingLevel& level);
/// The two engines for a coarser bone: `carver` carves along a trail, with G as its world frame; `engine`
/// continues the run's cut.
struct CoarserEngines {
  std::unique_ptr<simulation::CuttingEngine> carver, engine;
};
/// Makes the two engines. The error says why an engine cannot be made.
[[nodiscard]] tl::expected<CoarserEngines, std::string> MakeCoarserEngines(
    const CellSetup& setup, const simulation::PackingLevel& level, const simulation::Bone& bone,
    const EngineChoice& choice);

/// Describes the change in one line.
[[nodiscard]] std::string RezonedText(const Rezoned& rezoned);

}  // namespace osteon::session
