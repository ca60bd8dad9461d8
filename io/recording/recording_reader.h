#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "control/tick_record.h"
#include "io/recording/messages.h"
#include "simulation/frame_record.h"

namespace osteon::io {

/// A recording in memory, each list in the file's order.
struct Recording {
  SessionInfo session;
  std::vector<control::TickRecord> ticks;
  std::vector<simulation::FrameRecord> frames;
  std::vector<RecordedEvent> events;
  bool complete{false};  ///< false: the file ends early (the process died); what came before is all here
  std::uint64_t read_bytes{0};  ///< up to the end, or up to the first record that is cut off
};

/// Reads what Recorder wrote. Topics and records that it does not know are skipped.
/// The error names the file, the byte and the reason: not MCAP, not of this project, or damaged (the data's
/// CRC is checked). No byte of the file is trusted: a length that is not there ends the recording
/// (incomplete), never the program.
[[nodiscard]] tl::expected<Recording, std::string> ReadRecording(const std::filesystem::path& path);

}  // namespace osteon::io
