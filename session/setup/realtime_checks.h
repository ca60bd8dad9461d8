#pragma once

#include <functional>
#include <vector>

#include "session/setup/doctor.h"
#include "session/summary/summary.h"

namespace osteon::session {

/// Whether a machine whose threads wake this late can serve a servo loop of this period. `late` is the delay
/// of wake-ups:
///
///     p99.9 < period / 10   and   max < period / 2
///
/// A tick takes some tens of microseconds, and the arm needs its answer within the period. A wake-up that is
/// late by half a period leaves no time for both a slow tick and the network.
[[nodiscard]] bool Serves(const DurationFigures& late, double period_s);

/// Measures for `seconds` how late a thread wakes. The thread sleeps to absolute times a millisecond apart;
/// it is a thread of its own.
/// @param[in,out] realtime  in: request SCHED_FIFO as for the servo thread; out: whether it was granted
/// @param progress  called now and then with the time spent; may be empty
[[nodiscard]] DurationFigures TimerLatency(double seconds, bool& realtime,
                                           const std::function<void(double at_s)>& progress = {});

/// Examines the properties of a machine that a 1 kHz loop depends on: timer latency under this user's rights
/// with and without SCHED_FIFO, each for `seconds` with the CPUs awake as in a run, and the periods that this
/// latency can serve; priority and memory rights, idle states, kernel, isolated cores, governor.
/// @param progress  called now and then with the time spent, out of 2 `seconds`; may be empty
void ExamineRealtime(std::vector<Check>& checks, double seconds,
                     const std::function<void(double at_s)>& progress);

}  // namespace osteon::session
