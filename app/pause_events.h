#pragma once

#include <optional>
#include <vector>

#include "app/event_row.h"
#include "control/tick_record.h"

namespace osteon::app {

inline constexpr const char *kPauseEvent = "pause", *kResumeEvent = "resume";

/// An operator's pauses and their ends, found in a run's ticks: what stands among its events.
///
///     "pause"    when it was asked for, with the time until the arm rested [s]
///     "resume"   when it was asked to go on, with the time that the cell had been paused [s]
///
/// A request without effect (a pause of a paused cell, a resume of one that moves) is none.
class PauseEvents {
 public:
  /// The ticks of a run, one after the other.
  void Add(const control::TickRecord& tick);

  /// Complete so far, in their order; times count from the first tick.
  [[nodiscard]] const std::vector<EventRow>& rows() const { return rows_; }

 private:
  std::vector<EventRow> rows_;
  std::optional<rt::Nanoseconds> start_, asked_at_, paused_at_;
};

}  // namespace osteon::app
