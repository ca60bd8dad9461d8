#pragma once

#include <optional>
#include <vector>

#include "control/tick_record.h"
#include "session/summary/event_row.h"

namespace osteon::session {

/// Names of the rows in the list of events.
inline constexpr const char *kPauseEvent = "pause", *kResumeEvent = "resume";

/// Finds in a run's ticks the operator's pauses and their ends. Each becomes a row in the list of the run's
/// events:
///
///     "pause"    at the request, with the time until the arm was at rest [s]
///     "resume"   at the request, with the time for which the cell had been paused [s]
///
/// A request without effect (a pause of a paused cell, a resume of a moving one) makes no row.
class PauseEvents {
 public:
  /// Takes the next tick of a run.
  void Add(const control::TickRecord& tick);

  /// The complete rows so far, in order; times count from the first tick.
  [[nodiscard]] const std::vector<EventRow>& rows() const { return rows_; }

 private:
  std::vector<EventRow> rows_;
  std::optional<rt::Nanoseconds> start_;      // stamp of the run's first tick
  std::optional<rt::Nanoseconds> asked_at_;   // first request of a pause that is not in effect yet
  std::optional<rt::Nanoseconds> paused_at_;  // stamp of the pause in effect; none: the cell is not paused
};

}  // namespace osteon::session
