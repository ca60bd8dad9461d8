#pragma once

#include <span>
#include <string>
#include <vector>

#include "control/tick_record.h"
#include "report/time_axis.h"
#include "safety/fault.h"
#include "session/stops/trip_charts.h"

namespace osteon::session {

/// A fault on a stop's page.
struct StopFaultRow {
  safety::Fault fault{safety::Fault::kNone};
  std::string name;
  std::string seen;      ///< what was measured: the cause, with value and limit if they are known
  std::string reaction;  ///< what the cell does
  std::string clearing;  ///< how to clear the fault and go on
};

/// The contents of the page of a stop, a pause or a run's end. Views must outlive the call.
struct StopPageInput {
  std::string title;    ///< "Stop no. 1: force sensor stale"
  std::string heading;  ///< heading of the part on the reason: "What led to the stop", "How the run ended"
  std::string where;    ///< sentences about the recording, the time, and the part shown
  std::string ticks_file{};                ///< file beside the page with the table of all ticks; empty: none
  std::string view_command{};              ///< command that shows the recording at the stop; empty: not given
  std::string console_url{};               ///< address of the cell's page; empty: the cell no longer runs
  std::string no_fault_text{"No fault."};  ///< printed if there are no faults
  std::vector<StopFaultRow> faults{};
  std::span<const control::TickRecord> ticks{};
  report::TimeAxis time{};  ///< 0 is the tick at which the stop began
  double force_limit_N{0.0};
  const TripLimits& limits;
};

/// Makes one HTML page with the faults, for each fault the quantity that caused it and its limit, the forces
/// and the motion.
[[nodiscard]] std::string MakeStopPage(const StopPageInput& input);

}  // namespace osteon::session
