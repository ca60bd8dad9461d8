#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "io/recording/messages.h"
#include "kinematics/spatial.h"
#include "session/procedure/procedure_panel.h"
#include "session/procedure/session_file.h"

namespace osteon::session {

/// The page's messages of a procedure along a recording of its session: the plan, and where the session stood
/// at a time. The recording is read once in the background, since the panel counts from the tool's first cut.
class RecordedProcedure {
 public:
  /// Null: the recording is of no session, or its plan is not beside it.
  /// @param info  the recording's  @param X_WG  bone in the world
  [[nodiscard]] static std::unique_ptr<RecordedProcedure> Open(const std::filesystem::path& recording,
                                                               const io::SessionInfo& info, const Pose& X_WG);
  ~RecordedProcedure();
  RecordedProcedure(const RecordedProcedure&) = delete;
  RecordedProcedure& operator=(const RecordedProcedure&) = delete;

  /// The messages of ProcedurePanel. Any thread.
  [[nodiscard]] const std::string& PlanJson() const { return panel_.PlanJson(); }
  /// At a time of the recording [s]; at a later time than was read yet: the newest one.
  [[nodiscard]] std::string Json(double at_s) const;

 private:
  static constexpr double kStep_s = 0.1;

  RecordedProcedure(const std::filesystem::path& recording, SessionFile session,
                    const procedure::SurgicalPlan& plan, const Pose& X_WG);
  void Run(const std::filesystem::path& recording);
  // The session as it was at a stamp of the recording: passes that had ended, and the guidance's gain.
  [[nodiscard]] std::string JsonAt(rt::Nanoseconds stamp) const;

  const std::string name_;  // of the recording
  const SessionFile session_;
  ProcedurePanel panel_;
  mutable std::mutex mutex_;
  std::vector<std::string> steps_;  // of each kStep_s; guarded by mutex_, never empty
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace osteon::session
