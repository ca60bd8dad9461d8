#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "io/recording/mcap_reader.h"

namespace osteon::io {

/// What RecoverRecording found and kept.
struct Recovery {
  bool was_whole{false};  ///< nothing was to be done, and nothing was written
  std::uint64_t messages{0}, ticks{0}, frames{0}, events{0};  ///< kept
  std::uint64_t unchecked{0};        ///< of them, from the chunk that was being written: no CRC covers it
  std::uint64_t missing_ticks{0};    ///< numbers left out between the ticks that are there
  std::uint64_t tail_bytes{0};       ///< at the end, of a message that is cut off; or behind the end
  bool closed{false};                ///< the end was there: tail_bytes are behind it
  std::vector<McapDamage> damage;    ///< elsewhere: what was passed over
  double first_s{0.0}, last_s{0.0};  ///< log times of the first and last tick kept
  std::uint64_t bytes{0};            ///< of the file written
};

/// Makes a whole recording of one that is torn (the process or the power went) or damaged: every message that
/// is complete, as its bytes are, with index, statistics and footer. A chunk whose CRC is wrong is left out.
/// `to` appears whole or not at all; an existing file is replaced. Nothing is written where `from` is whole.
/// The error names the file and the reason: not MCAP, no osteon.Session left, a channel's number with more
/// than 64 meanings, or `to` cannot be written.
[[nodiscard]] tl::expected<Recovery, std::string> RecoverRecording(const std::filesystem::path& from,
                                                                   const std::filesystem::path& to);

}  // namespace osteon::io
