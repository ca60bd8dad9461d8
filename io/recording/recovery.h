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
  bool was_whole{false};  ///< nothing had to be done, and nothing was written
  std::uint64_t messages{0}, ticks{0}, frames{0}, events{0};  ///< kept
  std::uint64_t unchecked{0};        ///< those of the messages that no CRC covers: the last, unfinished chunk
  std::uint64_t missing_ticks{0};    ///< missing numbers between the ticks kept
  std::uint64_t tail_bytes{0};       ///< bytes of a truncated message at the end, or bytes after the end
  bool closed{false};                ///< the file's end was present: tail_bytes follow it
  std::vector<McapDamage> damage;    ///< skipped parts elsewhere
  double first_s{0.0}, last_s{0.0};  ///< log times of the first and last tick kept
  std::uint64_t bytes{0};            ///< size of the file written
};

/// Makes a complete recording from a torn one (the process died or the power failed) or a damaged one: it has
/// every complete message, its bytes unchanged, with index, statistics and footer. A chunk with a wrong CRC
/// is left out. `to` appears whole or not at all; an existing file is replaced. Nothing is written if `from`
/// is whole. The error names the file and the reason: not MCAP, no osteon.Session left, a channel number that
/// more than 64 channels use, or `to` cannot be written.
[[nodiscard]] tl::expected<Recovery, std::string> RecoverRecording(const std::filesystem::path& from,
                                                                   const std::filesystem::path& to);

}  // namespace osteon::io
