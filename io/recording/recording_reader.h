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
  /// false: the file is torn (end_error says where); the messages before that place are here
  bool complete{false};
  std::uint64_t read_bytes{0};  ///< bytes up to the file's end, or up to the first truncated message
  std::string end_error;        ///< RecordingStream::EndError
};

/// Reads a file of Recorder. Unknown topics and records are skipped. The error names the file, the byte and
/// the reason: not MCAP, not of this project, or damaged (the data's CRC is checked). Every length is
/// checked: a record that is longer than the rest of the file ends the recording, which is then incomplete.
[[nodiscard]] tl::expected<Recording, std::string> ReadRecording(const std::filesystem::path& path);

/// Type of a message in a recording.
enum class RecordedTopic : std::uint8_t { kOther, kSession, kTick, kFrame, kEvent };
/// The type of a channel's messages, by its schema's name.
[[nodiscard]] RecordedTopic TopicOf(const McapChannel& channel);

/// Reads a recording message by message, so that memory does not grow with the recording's length.
class RecordingStream {
 public:
  /// The error names the file and the reason.
  [[nodiscard]] static tl::expected<RecordingStream, std::string> Open(const std::filesystem::path& path);

  /// Reads the next message of a known topic into that topic's member. kOther at the end. The error names
  /// file, byte and reason; a file without an osteon.Session is an error as well.
  [[nodiscard]] tl::expected<RecordedTopic, std::string> Next();

  /// Finds the file's chunks (McapReader::FindChunks). Call SeekTo only after the first message, the session,
  /// was read.
  [[nodiscard]] std::vector<McapChunkPlace> FindChunks() { return reader_.FindChunks(); }
  void SeekTo(std::uint64_t offset) {
    reader_.SeekTo(offset);
    cut_off_ = false;
  }

  SessionInfo session;
  control::TickRecord tick;
  simulation::FrameRecord frame;
  RecordedEvent event;

  /// Valid after the last message: as Recording::complete and Recording::read_bytes.
  [[nodiscard]] bool complete() const { return reader_.complete() && !cut_off_; }
  /// The defect of the file's end, with the byte: the file ends early, or bytes follow its closing
  /// magic. Empty if nothing is wrong. Valid after the last message.
  [[nodiscard]] std::string EndError() const;
  [[nodiscard]] const McapReader& file() const { return reader_; }

 private:
  explicit RecordingStream(McapReader reader) : reader_(std::move(reader)) {}

  McapReader reader_;
  bool has_session_{false};  // an osteon.Session was read
  bool cut_off_{false};      // the last message of a torn file cannot be decoded: reading has ended
};

}  // namespace osteon::io
