#pragma once

#include <span>
#include <string>
#include <vector>

#include "control/tick_record.h"
#include "io/foxglove/foxglove_messages.h"
#include "session/setup/cell_setup.h"
#include "simulation/contact/contact_model.h"
#include "simulation/surface/surface_chunk.h"

namespace osteon::session {

/// What Foxglove draws of a cell: its frames, and the things in them.
///
///     world ─▶ base ─▶ link_1 ─▶ … ─▶ flange (as measured)
///       ├─▶ tool (as commanded), tool_measured, proxy (where the bone lets the tool be)
///       └─▶ bone
class CellScene {
 public:
  explicit CellScene(const CellSetup& setup);

  /// Where the frames are at a tick. @param model  frame 0: none yet, and the proxy is left out
  [[nodiscard]] std::vector<io::FramePlace> Frames(const control::TickRecord& tick,
                                                   const simulation::ContactModel& model) const;
  /// What does not change: the arm's bodies, the tool in `tool` and, transparent, in `proxy`, the zones.
  [[nodiscard]] std::vector<io::SceneEntity> Bodies() const;
  /// The coupling's and the hand's force as arrows (1 mm for 1 N), the planes that hold the tool.
  [[nodiscard]] std::vector<io::SceneEntity> Forces(const control::TickRecord& tick,
                                                    const simulation::ContactModel& model) const;
  /// A part of the carved bone, coloured by tissue, what was cut redder. Without faces it is empty.
  [[nodiscard]] io::SceneEntity BonePart(const std::string& id,
                                         std::span<const surface::SurfaceChunk> chunks) const;
  /// The arm's joints of a tick.
  [[nodiscard]] std::span<const double> Joints(const control::TickRecord& tick) const {
    return {tick.q_meas.data(), links_.size()};
  }

 private:
  struct Link {
    Pose X_PJ;
    Vector3 axis_J;
  };
  [[nodiscard]] io::SceneEntity Tool(const char* frame, double opacity) const;

  std::vector<Link> links_;
  Pose X_LF_, X_WB_, X_WG_;
  std::vector<io::SceneBall> tool_balls_;
  Vector3 p_TF_;  // the flange in T: where the tool's rod ends
  std::vector<safety::ZoneParams> zones_;
  std::vector<io::SceneColor> tissues_;  // by material
};

}  // namespace osteon::session
