#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/planned_cell.h"
#include "simulation/fidelity/recarve.h"
#include "simulation/frame_record.h"

namespace osteon::app {

struct ZoneGovernorParams {
  double rate_hz{250.0};     ///< that the median frame has to keep
  std::size_t window{200};   ///< frames in contact that the median is of
  double within_ratio{0.9};  ///< a coarser packing is to take so much of a frame's time at most
  std::string device;        ///< part of a Vulkan device's name
  /// The new packing is made in the calling thread, between two frames: for virtual time.
  bool at_once{false};
};

/// A coarser packing that took the place of a run's.
struct Rezoned {
  CoarserZones zones;
  double seen_us{0.0};       ///< the frames that asked for it
  simulation::Bone bone;     ///< as packed, before it was carved
  rt::Nanoseconds stamp{0};  ///< of the last frame before
};

/// Watches the frames of a planned run. Where they keep taking longer than the rate allows, the zones are
/// coarsened: the bone is packed again by a wider lattice of the same kind, carved along the way that the
/// tool has gone so far, and put in the old packing's place between two frames. Stiffness, law and tool stay.
/// All that was counted (volume, mass, work) goes on. What has been cut was cut with the error of its time;
/// from here on the coarser one holds, for the face that there is as well.
///
/// One thread calls it, the simulation's; the packing is made in a thread of its own meanwhile.
class ZoneGovernor {
 public:
  /// @param setup  planned and timed; must outlive it
  ZoneGovernor(const CellSetup& setup, const ZoneGovernorParams& params);
  ~ZoneGovernor();
  ZoneGovernor(const ZoneGovernor&) = delete;
  ZoneGovernor& operator=(const ZoneGovernor&) = delete;

  /// After each frame that was not refused. @param took_us  the frame
  void Saw(const simulation::FrameRecord& record, double took_us);

  struct Made {
    std::unique_ptr<simulation::CuttingEngine> engine;
    Rezoned rezoned;
  };
  /// What goes on instead of `now`, once it is ready, carved up to the last frame that was seen; nothing
  /// before. Does not wait.
  [[nodiscard]] std::optional<Made> Take(const simulation::CuttingEngine& now);

  /// After the last frame. Zones still in the making are given up, which it says.
  void End();

  /// What there is to say since the last call: that it makes coarser zones, or can't, and why. Empty:
  /// nothing.
  [[nodiscard]] std::string TakeNotice();

 private:
  struct Making;

  [[nodiscard]] std::optional<double> SlowMedian(double took_us);
  void Begin(double seen_us);
  void Make(Making& making);
  void Say(std::string text);

  const CellSetup& setup_;
  ZoneGovernorParams params_;
  Pose X_GW_;
  double lever_m_;
  simulation::PackingLevel level_;  ///< of the packing that runs
  std::vector<double> times_us_;    ///< of frames in contact, a ring
  std::size_t next_{0};
  bool ended_{false};  ///< nothing coarser would help, or can be had

  std::mutex mutex_;  ///< guards the trail
  simulation::ProxyTrail trail_;
  std::unique_ptr<Making> making_;
  std::thread thread_;
  std::string notice_;
};

/// The governor of a cell that was planned and timed; null for any other, and where the plan has given up the
/// rate: then nothing coarser has it.
[[nodiscard]] std::unique_ptr<ZoneGovernor> MakeGovernor(const CellSetup& setup, const std::string& device);

/// What was done, in a line.
[[nodiscard]] std::string RezonedText(const Rezoned& rezoned);

}  // namespace osteon::app
