#pragma once

#include <span>
#include <string>
#include <vector>

#include "app/report/time_axis.h"
#include "app/report/trip_charts.h"
#include "control/tick_record.h"
#include "safety/fault.h"

namespace osteon::app {

/// A fault as a stop's page shows it.
struct StopFaultRow {
  safety::Fault fault{safety::Fault::kNone};
  std::string name, seen, reaction, clearing;
};

/// What the page of a stop, a pause or a run's end is made of. Views must outlive the call.
struct StopPageInput {
  std::string title;    ///< "Stop no. 1: force sensor stale"
  std::string heading;  ///< of the part that says why: "What led to the stop", "How the run ended"
  std::string where;    ///< in which recording and when, and what is shown of it: sentences
  std::string no_fault_text{"No fault."};  ///< said where there are no rows
  std::vector<StopFaultRow> faults{};
  std::span<const control::TickRecord> ticks{};
  TimeAxis time{};  ///< 0: the stop
  double force_limit_N{0.0};
  const TripLimits& limits;
};

/// One HTML page: the faults, what tripped each of them with its limit, forces and motion.
[[nodiscard]] std::string MakeStopPage(const StopPageInput& input);

}  // namespace osteon::app
