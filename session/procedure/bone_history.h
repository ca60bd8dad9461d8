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

/// Passes of a session that were taken back.
struct TakenBackPasses {
  std::vector<surface::WayTimes> here;  ///< of the recording in question
  int earlier{0};                       ///< how many of the recordings before it
  friend bool operator==(const TakenBackPasses&, const TakenBackPasses&) = default;
};

/// Counts them. @param recording  name of its file in the session's folder
[[nodiscard]] TakenBackPasses FindTakenBack(const SessionFile& session, const std::string& recording);

/// The session around a carved surface, as far as the surface needs it. Both functions from any thread.
struct BoneHistory {
  /// Carves what counts of the session's earlier recordings, which it reads (seconds for an hour's). Empty:
  /// there are none. @throws std::runtime_error that names the file and the reason
  std::function<void(surface::CarvedField&)> carve_earlier{};
  std::function<TakenBackPasses()> taken_back{};  ///< as of now; empty: nothing is ever taken back
};

/// The history of a session that runs. @param session  outlives the functions  @param X_WG  bone in the world
[[nodiscard]] BoneHistory HistoryOf(const ProcedureSession& session, const Pose& X_WG);

}  // namespace osteon::session
