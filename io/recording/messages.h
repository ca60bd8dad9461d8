#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "control/tick_record.h"
#include "simulation/frame_record.h"

// The records as recording.proto's messages. The only source that sees libprotobuf is messages.cpp.

namespace osteon::io {

/// What was run, with what: the first message of a recording.
struct SessionInfo {
  rt::Nanoseconds stamp{0};    ///< when the session began, on the clock of the ticks
  std::string version;         ///< of osteon
  std::string engine, device;  ///< of the simulation
  std::string scene, tool;
  double force_limit_N{0.0};
  std::string config_text;  ///< the configuration as it was read
};

/// Something worth a line, e.g. a fault.
struct RecordedEvent {
  rt::Nanoseconds stamp{0};
  std::string text;
};

/// Serialised google.protobuf.FileDescriptorSet of recording.proto, as MCAP embeds it.
[[nodiscard]] std::string RecordingDescriptorSet();

/// Each overwrites `bytes` with the serialised message; the string's memory is reused.
void Encode(const SessionInfo& session, std::string& bytes);
void Encode(const control::TickRecord& record, std::string& bytes);
void Encode(const simulation::FrameRecord& record, std::string& bytes);
void Encode(const RecordedEvent& event, std::string& bytes);

/// Each parses what Encode wrote: bit for bit the same values. An empty string on success, else the reason.
/// Values that are not finite pass: they were recorded so.
[[nodiscard]] std::string Decode(std::span<const char> bytes, SessionInfo& session);
[[nodiscard]] std::string Decode(std::span<const char> bytes, control::TickRecord& record);
[[nodiscard]] std::string Decode(std::span<const char> bytes, simulation::FrameRecord& record);
[[nodiscard]] std::string Decode(std::span<const char> bytes, RecordedEvent& event);

}  // namespace osteon::io
