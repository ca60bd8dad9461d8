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

/// Tool and path of each pass of a session that counts; the path is the simulated tool's, in the bone's
/// frame. Passes that were taken back are left out.
class SessionCut {
 public:
  /// @param tools  one for each of session.diameters_mm  @param X_WG  the bone in the world
  SessionCut(const SessionFile& session, std::vector<simulation::Tool> tools, const Pose& X_WG);

  /// Takes a frame of a recording of the session; it counts if it belongs to a pass.
  void Add(const std::string& recording, const simulation::FrameRecord& frame);

  /// The passes' paths in their order. Views of this object.
  [[nodiscard]] std::vector<simulation::ToolPath> paths() const;
  /// Largest distance of a path from the frames' own (ProxyPath::tolerance_m).
  [[nodiscard]] double tolerance_m() const;
  [[nodiscard]] const std::vector<simulation::Tool>& tools() const { return tools_; }

  std::optional<procedure::PlannedCavity> planned{};  ///< of the session's plan, if it was read

 private:
  struct Pass {
    std::string recording;
    rt::Nanoseconds begin, end;
    int tool;
    simulation::ProxyPath path;
  };
  std::vector<simulation::Tool> tools_;
  std::vector<Pass> passes_;
};

/// The session that a recording belongs to, by the session.json beside it; nothing: none, or it does not name
/// the recording.
[[nodiscard]] std::optional<SessionFile> FindSessionOf(const std::filesystem::path& recording);
/// The session as it was at a recording's end: segments and passes up to its last one.
[[nodiscard]] SessionFile SessionUpTo(SessionFile session, const std::string& recording);

/// Whether a frame of a recording, known by its name, counts.
using CountsFrame = std::function<bool(const std::string& recording, const simulation::FrameRecord& frame)>;

/// Reads the frames of all recordings of a session. The error names the file.
/// @param counts  empty: each frame does
[[nodiscard]] tl::expected<SessionCut, std::string> ReadSessionCut(const std::filesystem::path& folder,
                                                                   const SessionFile& session,
                                                                   std::vector<simulation::Tool> tools,
                                                                   const Pose& X_WG,
                                                                   const CountsFrame& counts = {});

/// Reads what the session's recordings before this one have cut; nothing: it is the first, or the session
/// does not name it. The error names the file. @param recording  name of its file in the folder
[[nodiscard]] tl::expected<std::optional<SessionCut>, std::string> ReadCutBefore(
    const std::filesystem::path& folder, const SessionFile& session, const std::string& recording,
    std::vector<simulation::Tool> tools, const Pose& X_WG);

/// Reads the plan of a session's folder and its planned cavity; nothing where it cannot be read.
[[nodiscard]] std::optional<procedure::PlannedCavity> ReadPlannedCavity(const std::filesystem::path& folder,
                                                                        const SessionFile& session);

/// Writes the passes of a recording's session as a table, one pass a row: `<stem>_passes.csv` in `folder`.
/// @param start  stamp of the recording's start, where its times count from
/// The error names the path.
[[nodiscard]] tl::expected<std::filesystem::path, std::string> WritePassTable(
    const SessionFile& session, const std::filesystem::path& recording, rt::Nanoseconds start,
    const std::filesystem::path& folder);

}  // namespace osteon::session
