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

/// Makes the messages that show a procedure on the page, for each time of a recording of its session: the
/// plan, and the state of the session. The recording is read once in the background, because the panel's
/// figures depend on all frames since the first cut of the tool in use.
class RecordedProcedure {
 public:
  /// Starts reading. @param info session information of the recording @param X_WG pose of the bone in the
  /// world
  /// @returns null if the recording belongs to no session, or the plan is not beside it
  [[nodiscard]] static std::unique_ptr<RecordedProcedure> Open(const std::filesystem::path& recording,
                                                               const io::SessionInfo& info, const Pose& X_WG);
  ~RecordedProcedure();
  RecordedProcedure(const RecordedProcedure&) = delete;
  RecordedProcedure& operator=(const RecordedProcedure&) = delete;

  /// The message with the plan (ProcedurePanel::PlanJson). Any thread.
  [[nodiscard]] const std::string& PlanJson() const { return panel_.PlanJson(); }
  /// Returns the message for a time of the recording [s]; if that time was not read yet, returns the newest
  /// message.
  [[nodiscard]] std::string Json(double at_s) const;

 private:
  static constexpr double kStep_s = 0.1;  // recorded time from one message to the next

  RecordedProcedure(const std::filesystem::path& recording, SessionFile session,
                    const procedure::SurgicalPlan& plan, const Pose& X_WG);
  void Run(const std::filesystem::path& recording);  // the thread reads all and fills steps_
  // Makes the message of the session as it was at a stamp: with the passes that had ended, and the guidance's
  // gain.
  [[nodiscard]] std::string JsonAt(rt::Nanoseconds stamp) const;

  const std::string name_;  // name of the recording's file
  const SessionFile session_;
  ProcedurePanel panel_;
  mutable std::mutex mutex_;
  std::vector<std::string> steps_;  // a message for each kStep_s; guarded by mutex_, never empty
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace osteon::session
