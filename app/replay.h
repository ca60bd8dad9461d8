#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/cell_config.h"
#include "io/recording/recording_reader.h"

namespace osteon::app {

/// The first value that came out otherwise.
struct ReplayDifference {
  std::uint64_t tick{0};
  std::string field;               ///< as a column of the exported ticks
  std::string recorded, replayed;  ///< decimal, enough digits to tell them apart
};

struct ReplayResult {
  std::uint64_t ticks{0};            ///< that were run again
  std::uint64_t different_ticks{0};  ///< of them
  std::optional<ReplayDifference> first_difference;
  std::uint64_t not_run{0};  ///< ticks at the end that could not be run again
  std::string why_not;       ///< why
  /// Every tick that could be was run again and gave the same bits; and none could not, but for those of the
  /// last second that saw a frame after the last one that was recorded: the end of a run that was killed.
  bool identical{false};
};

/// A new servo loop of `cell` over the recorded inputs: commands and records, bit for bit. What the loop was
/// given is the arm's message or its absence, the force reading, the contact model that the tick saw, the
/// time, and whether a stop had been asked for.
///
/// Ends early where an input is not there: a tick that the recorder had no room for, a contact model whose
/// frame is missing, a recording from before inputs were kept.
/// The bits are those of this program on this kind of processor: the C library picks its sine by what the
/// processor can do.
[[nodiscard]] ReplayResult Replay(const io::Recording& recording, const config::CellConfig& cell);

}  // namespace osteon::app
