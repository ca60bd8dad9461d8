#pragma once

#include <optional>
#include <string>

#include "base/clock.h"
#include "config/reading/cell_config.h"
#include "io/recording/recorder.h"
#include "safety/motion_permit.h"
#include "session/run/cell_run.h"

// The end of a run: when it is asked for, what the recording says of it, and why a run never began.

namespace osteon::session {

/// Whether somebody has asked for the run's end. A session that is finished asks as its operator.
[[nodiscard]] bool IsStopAsked(const CellRunParams& params);

/// Records why a run has ended that was ended only by its operator or its duration; nothing after a fault.
/// @param seconds  of rendering that were asked for
void RecordEnd(io::Recorder& recorder, rt::Nanoseconds stamp, const CellRunResult& result, double seconds);

/// Says why the arm's messages did not come: a guard that does not run lets none through.
/// @param arm  the connection's own diagnosis
[[nodiscard]] std::string DescribeMissingArm(const std::string& arm,
                                             const std::optional<config::GuardConfig>& guard,
                                             safety::MotionPermits permits);

/// Adds to the result of a run that never began what kept arm or devices from it.
/// @param arm, devices  their diagnoses; empty: nothing is wrong
/// @param permits  of the loop's last tick
void AddDiagnosis(CellRunResult& result, const std::string& arm, const std::string& devices,
                  safety::MotionPermits permits);

}  // namespace osteon::session
