#pragma once

#include <functional>
#include <vector>

#include "app/doctor.h"
#include "app/summary.h"

namespace osteon::app {

/// Whether a servo loop of this period may be served by a machine whose threads wake so late:
///
///     p99.9 < period / 10   and   max < period / 2
///
/// A tick takes some tens of microseconds, and the arm has to have its answer within the period: late by half
/// of it there is no room for both a slow tick and the wire.
[[nodiscard]] bool Serves(const DurationFigures& late, double period_s);

/// How late a thread wakes that sleeps to absolute times, a millisecond apart, for `seconds`. In a thread of
/// its own.
/// @param[in,out] realtime  ask for SCHED_FIFO, as the servo loop's thread does; whether it was granted
/// @param progress  called now and then with the time spent; may be empty
[[nodiscard]] DurationFigures TimerLatency(double seconds, bool& realtime,
                                           const std::function<void(double at_s)>& progress = {});

/// What a 1 kHz loop needs of a machine: timer latency under this user's rights with and without SCHED_FIFO,
/// each for `seconds`, with the CPUs awake as a run has them, which periods that serves, priority and memory
/// rights, idle states, kernel, isolated cores, governor.
/// @param progress  called now and then with the time spent, of 2 `seconds`; may be empty
void ExamineRealtime(std::vector<Check>& checks, double seconds,
                     const std::function<void(double at_s)>& progress);

}  // namespace osteon::app
