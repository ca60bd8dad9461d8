#pragma once

#include <span>
#include <string>

#include "console/stream/live_status.h"
#include "io/recording/messages.h"

// The stream as JSON messages for a page. Lengths in m and poses as rows of [R | p], 12 numbers, in W;
// figures for people in the units of their names.

namespace osteon::console {

/// {"type": "live", "windows": […], "status": …, "view": …} of the windows since the last message, oldest
/// first: a row for each window's place in the strip charts (kStripFields), and status and poses of the last
/// one.
/// @pre windows is not empty
[[nodiscard]] std::string LiveJson(std::span<const LiveWindow> windows, const LiveContext& context);

/// Names of the numbers of a window's row, in order.
inline constexpr const char* kStripFields[] = {
    "time_s",      "force_least_N",   "force_most_N",   "hand_most_N", "depth_mm",
    "removed_mm3", "compute_most_us", "wakeup_most_us", "frame_us",    "speed_most_mm_per_s"};

/// {"type": "events", "events": [[time_s, text], …]}; time of log, as in the windows' rows.
[[nodiscard]] std::string EventsJson(std::span<const io::RecordedEvent> events);

}  // namespace osteon::console
