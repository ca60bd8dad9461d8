#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "base/clock.h"
#include "io/recording/messages.h"
#include "kinematics/spatial.h"
#include "session/procedure/session_cut.h"
#include "session/setup/cell_setup.h"
#include "simulation/surface/carved_field.h"
#include "simulation/surface/swept_batches.h"
#include "simulation/tools/tool.h"

namespace osteon::session {

/// The facts that carving a recording's bone needs beside the recording's messages: every tool, what the
/// session's earlier recordings cut, and which passes the session undid later.
struct RecordedCut {
  std::vector<simulation::Tool> tools;  ///< the tools, by TickInput::tool_index; at least one
  Pose X_WG{Pose::Identity()};
  std::vector<surface::SweepTimes> undone{};  ///< times of the passes that were undone later
  std::optional<SessionCut>
      earlier{};  ///< the cut of the session's earlier recordings; empty: this is the first

  /// Whether a frame's cut is to be carved: its pass was not undone later.
  /// @param pose_stamp  the frame's ContactModel::pose_stamp
  [[nodiscard]] bool Counts(rt::Nanoseconds pose_stamp) const;
  /// Carves the bone that was cut before the recording begins.
  void CarveEarlier(surface::CarvedField& field) const;
};

/// Reads a RecordedCut from a recording and the session.json beside it. Without a session the cell's tool is
/// the only tool. The error names the file and the reason.
/// @param info, setup  session information and cell of the recording
[[nodiscard]] tl::expected<std::shared_ptr<const RecordedCut>, std::string> ReadRecordedCut(
    const std::filesystem::path& recording, const io::SessionInfo& info, const CellSetup& setup);

}  // namespace osteon::session
