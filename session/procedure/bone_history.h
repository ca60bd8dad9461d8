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

/// Passes of a session that were taken back, as seen from one of its recordings.
struct TakenBackPasses {
  std::vector<surface::WayTimes> here;  ///< times of such passes of the recording in question
  int earlier{0};                       ///< number of such passes in the recordings before it
  friend bool operator==(const TakenBackPasses&, const TakenBackPasses&) = default;
};

/// Finds a session's passes that were taken back. @param recording  its file's name in the session's folder
[[nodiscard]] TakenBackPasses FindTakenBack(const SessionFile& session, const std::string& recording);

/// The session around a carved surface, as far as the surface needs it. Both functions may be called from any
/// thread.
struct BoneHistory {
  /// Carves the passes that count of the session's earlier recordings. It reads these recordings, which takes
  /// seconds for an hour of them. Empty: there are none. @throws std::runtime_error that names the file and
  /// the reason
  std::function<void(surface::CarvedField&)> carve_earlier{};
  /// Returns the passes that are taken back now; empty: no pass is ever taken back.
  std::function<TakenBackPasses()> taken_back{};
};

/// Makes the history of a running session. @param session  outlives the functions  @param X_WG  bone in the
/// world
[[nodiscard]] BoneHistory HistoryOf(const ProcedureSession& session, const Pose& X_WG);

}  // namespace osteon::session
