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

/// The parts of a cell that Foxglove draws: its frames, and the bodies in them.
///
///     world ─▶ base ─▶ link_1 ─▶ … ─▶ flange (as measured)
///       ├─▶ tool (as commanded), tool_measured, proxy (the tool's collision-free pose)
///       └─▶ bone
class CellScene {
 public:
  /// @param tools  the tools of a procedure, in the order of TickInput::tool_index; empty: only the cell's
  /// own tool
  explicit CellScene(const CellSetup& setup, std::span<const ProcedureTool> tools = {});

  /// Returns the frames' poses at a tick. @param model  the newest contact model; if its frame is 0 there is
  /// none yet, and the proxy is left out
  [[nodiscard]] std::vector<io::FramePlace> Frames(const control::TickRecord& tick,
                                                   const simulation::ContactModel& model) const;
  /// Returns the bodies of arm, tool (Tools) and zones. They change only if another tool comes into use.
  [[nodiscard]] std::vector<io::SceneEntity> Bodies(std::size_t tool) const;
  /// Returns the tool in use twice: in the frame `tool` and, transparent, in the frame `proxy`.
  /// @param tool  TickInput::tool_index
  [[nodiscard]] std::vector<io::SceneEntity> Tools(std::size_t tool) const;
  /// Returns the coupling's force and the hand's force as arrows (1 mm per newton), and the contact planes as
  /// plates.
  [[nodiscard]] std::vector<io::SceneEntity> Forces(const control::TickRecord& tick,
                                                    const simulation::ContactModel& model) const;
  /// Returns a part of the carved bone, coloured by tissue. Cut faces have a redder colour. Its mesh is empty
  /// if the chunks have no faces.
  [[nodiscard]] io::SceneEntity BonePart(const std::string& id,
                                         std::span<const surface::SurfaceChunk> chunks) const;
  /// Returns the arm's measured joint angles of a tick [rad].
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
    Vector3 p_TF;  // position of the flange in T, at which the tool's rod ends
  };
  // Makes the tool's balls and finds the position of the flange. X_FT: pose of the tool on the flange.
  [[nodiscard]] static DrawnTool Draw(const simulation::Tool& tool, const Pose& X_FT);
  // Makes a body in `frame` of the tool's balls and its rod to the flange. opacity: 0 … 1.
  [[nodiscard]] static io::SceneEntity BodyOf(const DrawnTool& tool, const char* frame, double opacity);

  std::vector<Link> links_;
  Pose X_LF_, X_WB_, X_WG_;
  std::vector<DrawnTool> tools_;  // at least one
  std::vector<safety::ZoneParams> zones_;
  std::vector<io::SceneColor> tissues_;  // colour of each material
};

}  // namespace osteon::session
