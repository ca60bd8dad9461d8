#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "io/recording/mcap_reader.h"

namespace osteon::io {

/// Result of RecoverRecording.
struct Recovery {
  bool was_whole{false};  ///< the recording was complete, so nothing was written
  std::uint64_t messages{0}, ticks{0}, frames{0}, events{0};  ///< number of each that were kept
  std::uint64_t unchecked{0};      ///< kept messages that no CRC covers: those of the last, unfinished chunk
  std::uint64_t missing_ticks{0};  ///< missing numbers between the ticks kept
  /// bytes of a truncated message at the file's end, or bytes after the closing magic
  std::uint64_t tail_bytes{0};
  bool closed{false};                ///< the closing magic was present; tail_bytes follow it
  std::vector<McapDamage> damage;    ///< skipped parts elsewhere
  double first_s{0.0}, last_s{0.0};  ///< log times of the first and last tick kept
  std::uint64_t bytes{0};            ///< size of the file written
};

/// Makes a complete recording from a torn one (the process died or the power failed) or a damaged one: it has
/// every complete message, its bytes unchanged, with index, statistics and footer. A chunk with a wrong CRC
/// is left out. `to` is written completely or not at all; an existing file is replaced. Nothing is written if
/// `from` is complete. The error names the file and the reason: `from` is not MCAP, has no osteon.Session
/// left, or uses one channel number for more than 64 channels; or `to` cannot be written.
[[nodiscard]] tl::expected<Recovery, std::string> RecoverRecording(const std::filesystem::path& from,
                                                                   const std::filesystem::path& to);

}  // namespace osteon::io
