#pragma once

#include <optional>
#include <string>

#include "base/clock.h"
#include "config/reading/cell_config.h"
#include "io/recording/recorder.h"
#include "safety/motion_permit.h"
#include "session/run/cell_run.h"

// The end of a run: whether it is requested, how it is recorded, and why a run never began.

namespace osteon::session {

/// Whether the run is to end: its stop flag is set, or a person has finished the session. A finished session
/// also requests an operator's stop (base::RequestInterrupt), so that the run's end is reported as one.
[[nodiscard]] bool PollStop(const CellRunParams& params);

/// Records why a run has ended, if only its operator or its duration ended it; after a fault, records
/// nothing.
/// @param seconds  requested duration of rendering
void RecordEnd(io::Recorder& recorder, rt::Nanoseconds stamp, const CellRunResult& result, double seconds);

/// Says why the arm's messages did not arrive. If the cell has a guard, suggests that the guard does not run.
/// @param arm  the connection's own diagnosis
[[nodiscard]] std::string DescribeMissingArm(const std::string& arm,
                                             const std::optional<config::GuardConfig>& guard,
                                             safety::MotionPermits permits);

/// Adds the reasons to the result of a run that never began.
/// @param result  unchanged if the run began
/// @param arm, devices  diagnoses of the arm's and the devices' connections; empty: nothing is wrong
/// @param permits  motion permits of the loop's last tick
void AddDiagnosis(CellRunResult& result, const std::string& arm, const std::string& devices,
                  safety::MotionPermits permits);

}  // namespace osteon::session
