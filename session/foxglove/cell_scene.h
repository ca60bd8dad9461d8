#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "control/tick_record.h"
#include "io/foxglove/foxglove_messages.h"
#include "session/procedure/procedure_tools.h"
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
  /// @param tools  of a procedure, by the index that the ticks name; empty: the cell's own alone
  explicit CellScene(const CellSetup& setup, std::span<const ProcedureTool> tools = {});

  /// Where the frames are at a tick. @param model  frame 0: none yet, and the proxy is left out
  [[nodiscard]] std::vector<io::FramePlace> Frames(const control::TickRecord& tick,
                                                   const simulation::ContactModel& model) const;
  /// The arm's bodies, Tools and the zones: they change with the tool alone.
  [[nodiscard]] std::vector<io::SceneEntity> Bodies(std::size_t tool) const;
  /// The tool in use in `tool` and, transparent, in `proxy`. @param tool  TickInput::tool_index
  [[nodiscard]] std::vector<io::SceneEntity> Tools(std::size_t tool) const;
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
  struct DrawnTool {
    std::vector<io::SceneBall> balls;
    Vector3 p_TF;  // the flange in T: where the tool's rod ends
  };
  [[nodiscard]] static DrawnTool Draw(const simulation::Tool& tool, const Pose& X_FT);
  [[nodiscard]] static io::SceneEntity BodyOf(const DrawnTool& tool, const char* frame, double opacity);

  std::vector<Link> links_;
  Pose X_LF_, X_WB_, X_WG_;
  std::vector<DrawnTool> tools_;  // at least one
  std::vector<safety::ZoneParams> zones_;
  std::vector<io::SceneColor> tissues_;  // by material
};

}  // namespace osteon::session
