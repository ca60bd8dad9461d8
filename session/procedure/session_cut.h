#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "kinematics/spatial.h"
#include "procedure/plan/planned_cavity.h"
#include "session/procedure/session_file.h"
#include "simulation/engine/frame_record.h"
#include "simulation/tools/proxy_path.h"
#include "simulation/tools/swept_tool.h"
#include "simulation/tools/tool.h"

namespace osteon::session {

/// Tool and path of each pass of a session that was not undone. The path is that of the simulated tool, in
/// the bone's frame.
class SessionCut {
 public:
  /// @param tools  one for each of session.diameters_mm  @param X_WG pose of the bone in the world
  SessionCut(const SessionFile& session, std::vector<simulation::Tool> tools, const Pose& X_WG);

  /// Takes a frame of a recording of the session. The frame is used if it belongs to a pass that was not
  /// undone.
  void Add(const std::string& recording, const simulation::FrameRecord& frame);

  /// The paths of the passes, in their order. They refer to this object, which must outlive them.
  [[nodiscard]] std::vector<simulation::ToolPath> paths() const;
  /// Largest distance by which a thinned path differs from the frames' poses (ProxyPath::tolerance_m).
  [[nodiscard]] double tolerance_m() const;
  [[nodiscard]] const std::vector<simulation::Tool>& tools() const { return tools_; }

  std::optional<procedure::PlannedCavity> planned{};  ///< planned cavity of the session's plan, if the plan
                                                      ///< was read

 private:
  // A pass that was not undone, with the path of its tool.
  struct Pass {
    std::string recording;
    rt::Nanoseconds begin, end;
    int tool;
    simulation::ProxyPath path;
  };
  std::vector<simulation::Tool> tools_;
  std::vector<Pass> passes_;
};

/// Finds the session to which a recording belongs, by the session.json beside it. Nothing if there is no such
/// file, or it does not name the recording.
[[nodiscard]] std::optional<SessionFile> FindSessionOf(const std::filesystem::path& recording);
/// Returns the session as it was at a recording's end: with the segments and passes up to the last ones of
/// the recording.
[[nodiscard]] SessionFile SessionUpTo(SessionFile session, const std::string& recording);

/// Decides whether a frame is included. @param recording  name of the frame's recording
using CountsFrame = std::function<bool(const std::string& recording, const simulation::FrameRecord& frame)>;

/// Reads the frames of all recordings of a session. The error names the file.
/// @param counts  decides which frames are included; empty: all
[[nodiscard]] tl::expected<SessionCut, std::string> ReadSessionCut(const std::filesystem::path& folder,
                                                                   const SessionFile& session,
                                                                   std::vector<simulation::Tool> tools,
                                                                   const Pose& X_WG,
                                                                   const CountsFrame& counts = {});

/// Reads the passes of the session's recordings before this one. Returns nothing if this recording is the
/// first, or the session does not name it. The error names the file. @param recording  name of its file in
/// the folder
[[nodiscard]] tl::expected<std::optional<SessionCut>, std::string> ReadCutBefore(
    const std::filesystem::path& folder, const SessionFile& session, const std::string& recording,
    std::vector<simulation::Tool> tools, const Pose& X_WG);

/// Reads the planned cavity from the plan in a session's folder; nothing if the plan cannot be read.
[[nodiscard]] std::optional<procedure::PlannedCavity> ReadPlannedCavity(const std::filesystem::path& folder,
                                                                        const SessionFile& session);

/// Writes the passes of a recording's session as a table, one pass a row: `<stem>_passes.csv` in `folder`.
/// @param start  stamp of the recording's start, at which the table's times are 0
/// The error names the path.
[[nodiscard]] tl::expected<std::filesystem::path, std::string> WritePassTable(
    const SessionFile& session, const std::filesystem::path& recording, rt::Nanoseconds start,
    const std::filesystem::path& folder);

}  // namespace osteon::session
