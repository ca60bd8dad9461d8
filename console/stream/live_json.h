#pragma once

#include <span>
#include <string>

#include "console/stream/live_status.h"
#include "io/recording/messages.h"

// The stream as JSON messages for a page. Lengths are in m, poses are rows of [R | p], 12 numbers, in W.
// Figures for people have the units that their names state.

namespace osteon::console {

/// Makes {"type": "live", "windows": […], "status": …, "view": …} from the windows since the last message,
/// oldest first. "windows" has a row for each window, for the strip charts (kStripFields); status and poses
/// are those of the last window.
/// @pre windows is not empty
[[nodiscard]] std::string LiveJson(std::span<const LiveWindow> windows, const LiveContext& context);

/// Names of the numbers of a window's row, in order.
inline constexpr const char* kStripFields[] = {
    "time_s",      "force_least_N",   "force_most_N",   "hand_most_N", "depth_mm",
    "removed_mm3", "compute_most_us", "wakeup_most_us", "frame_us",    "speed_most_mm_per_s"};

/// Makes {"type": "events", "events": [[time_s, text], …]}; the times are log times, as in the windows' rows.
[[nodiscard]] std::string EventsJson(std::span<const io::RecordedEvent> events);

}  // namespace osteon::console
