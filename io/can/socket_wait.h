#pragma once

#include <sys/socket.h>

#include "control/rt/clock.h"
#include "control/rt/marker.h"
#include "io/can/can_bus.h"

namespace osteon::io {

/// Waits until the socket has something to read, at most until `deadline` on CLOCK_MONOTONIC. kOk, kEmpty, or
/// kDown where the socket is gone.
[[nodiscard]] CanResult WaitReadable(int socket, rt::Nanoseconds deadline) OSTEON_RT;

/// When a received message reached this machine, on CLOCK_MONOTONIC: the kernel stamps it on CLOCK_REALTIME
/// (SO_TIMESTAMPNS), its age carries over. The time of this call where there is no such stamp, or somebody
/// has set that clock in between.
[[nodiscard]] rt::Nanoseconds ArrivalTime(msghdr& message) OSTEON_RT;

}  // namespace osteon::io
