#pragma once

#include <functional>
#include <string>
#include <vector>

#include "kinematics/spatial.h"
#include "session/procedure/session_file.h"
#include "simulation/surface/carved_field.h"
#include "simulation/surface/swept_batches.h"

namespace osteon::session {

class ProcedureSession;

/// The passes of a session that were undone, in one recording of the session and in the recordings before
/// it.
struct UndonePasses {
  std::vector<surface::SweepTimes> here;  ///< times of such passes in this recording
  int earlier{0};                         ///< number of such passes in earlier recordings
  friend bool operator==(const UndonePasses&, const UndonePasses&) = default;
};

/// Finds a session's passes that were undone. @param recording  name of the recording's file in the
/// session's folder
[[nodiscard]] UndonePasses FindUndone(const SessionFile& session, const std::string& recording);

/// The facts about a session that the display of its carved surface needs. Both functions may be called from
/// any thread.
struct BoneHistory {
  /// Carves the passes of the session's earlier recordings that were not undone. It reads these
  /// recordings, which takes seconds for an hour of them. Empty function: there are no earlier recordings.
  /// @throws std::runtime_error that names the file and the reason
  std::function<void(surface::CarvedField&)> carve_earlier{};
  /// Returns the passes that are undone at the time of the call. Empty function: none ever is.
  std::function<UndonePasses()> undone{};
};

/// Makes the history of a running session. @param session  must outlive the functions  @param X_WG  pose of
/// the bone in the world
[[nodiscard]] BoneHistory HistoryOf(const ProcedureSession& session, const Pose& X_WG);

}  // namespace osteon::session
