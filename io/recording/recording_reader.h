#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "control/tick_record.h"
#include "io/recording/mcap_reader.h"
#include "io/recording/messages.h"
#include "simulation/engine/frame_record.h"

namespace osteon::io {

/// A recording in memory, each list in the file's order.
struct Recording {
  SessionInfo session;
  std::vector<control::TickRecord> ticks;
  std::vector<simulation::FrameRecord> frames;
  std::vector<RecordedEvent> events;
  bool complete{false};         ///< false: see end_error; everything before the end is here
  std::uint64_t read_bytes{0};  ///< up to the end, or up to the first truncated message
  std::string end_error;        ///< RecordingStream::EndError
};

/// Reads a file of Recorder. Unknown topics and records are skipped. The error names the file, the byte and
/// the reason: not MCAP, not of this project, or damaged (the data's CRC is checked). No byte of the file is
/// trusted: a length beyond the file ends the recording (incomplete), never the program.
[[nodiscard]] tl::expected<Recording, std::string> ReadRecording(const std::filesystem::path& path);

/// Type of a message in a recording.
enum class RecordedTopic : std::uint8_t { kOther, kSession, kTick, kFrame, kEvent };
/// The type of a channel's messages, by its schema's name.
[[nodiscard]] RecordedTopic TopicOf(const McapChannel& channel);

/// Reads a recording one message after the other: hours need no more memory than seconds.
class RecordingStream {
 public:
  /// The error names the file and the reason.
  [[nodiscard]] static tl::expected<RecordingStream, std::string> Open(const std::filesystem::path& path);

  /// Reads the next message of a known topic into that topic's member. kOther at the end. The error names
  /// file, byte and reason; a file that ends without an osteon.Session is an error as well.
  [[nodiscard]] tl::expected<RecordedTopic, std::string> Next();

  /// As McapReader's. SeekTo needs a session that was read (the first message).
  [[nodiscard]] std::vector<McapChunkPlace> FindChunks() { return reader_.FindChunks(); }
  void SeekTo(std::uint64_t offset) {
    reader_.SeekTo(offset);
    cut_off_ = false;
  }

  SessionInfo session;
  control::TickRecord tick;
  simulation::FrameRecord frame;
  RecordedEvent event;

  /// Valid at the end, as in Recording.
  [[nodiscard]] bool complete() const { return reader_.complete() && !cut_off_; }
  /// The fault at the file's end, with its byte: it ends early, or something follows its end. Empty:
  /// nothing. Valid at the end.
  [[nodiscard]] std::string EndError() const;
  [[nodiscard]] const McapReader& file() const { return reader_; }

 private:
  explicit RecordingStream(McapReader reader) : reader_(std::move(reader)) {}

  McapReader reader_;
  bool has_session_{false};  // an osteon.Session was read
  bool cut_off_{false};      // the last message of a torn file cannot be decoded: reading has ended
};

}  // namespace osteon::io
