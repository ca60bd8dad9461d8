#pragma once

#include <span>
#include <vector>

#include "console/server/foxglove_server.h"
#include "console/server/surface_store.h"
#include "console/stream/live_feed.h"
#include "session/foxglove/cell_scene.h"

namespace osteon::session {

/// The topics with Foxglove's schemas that a cell or a recording has, in this order:
///
///     tf       frames               scene    bodies, once      forces   arrows and planes
///     joints   the arm's joints     log      events            bone     the carved surface
[[nodiscard]] const std::vector<console::FoxgloveChannel>& CellTopics();
enum class CellTopic : std::size_t { kFrames, kScene, kForces, kJoints, kLog, kBone };

/// Returns how severe an event is: a fault is an error, all others are information.
[[nodiscard]] io::LogLevel LevelOf(const std::string& event);

/// Sends a running cell's data to Foxglove's viewers: the newest recorded data, some 30 times a second, and
/// the bricks of the carved surface that changed. Besides CellTopics it has the topics `tick` and `frame`, as
/// in a recording.
class LiveTopics final : public console::FoxgloveSource {
 public:
  /// @param feed, surface  must outlive this  @param tools  as for CellScene
  LiveTopics(const CellSetup& setup, const console::LiveFeed& feed, const console::SurfaceStore& surface,
             std::span<const ProcedureTool> tools = {});

  [[nodiscard]] const std::vector<console::FoxgloveChannel>& channels() const override { return channels_; }
  void New(std::size_t channel, console::FoxgloveCursor& cursor,
           std::vector<console::FoxgloveMessage>& out) const override;

 private:
  // Appends a message with the bricks that the viewer does not have yet. Appends nothing if there are no such
  // bricks and the surface's grid has not changed.
  void NewBone(console::FoxgloveCursor& cursor, std::vector<console::FoxgloveMessage>& out) const;

  CellScene scene_;
  const console::LiveFeed& feed_;
  const console::SurfaceStore& surface_;
  std::vector<console::FoxgloveChannel> channels_;
};

}  // namespace osteon::session
