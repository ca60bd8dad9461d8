#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "io/recording/recording_reader.h"

namespace osteon::session {

/// A recording as a time line. Opening reads only the headers of the chunks, so a recording of an hour opens
/// as fast as one of a second. Going to any time unpacks one chunk.
class RecordingTimeline {
 public:
  /// The error names the file and the reason: the file is no recording, or has no tick.
  [[nodiscard]] static tl::expected<RecordingTimeline, std::string> Open(const std::filesystem::path& path);

  [[nodiscard]] const io::SessionInfo& session() const { return stream_.session; }
  [[nodiscard]] double duration_s() const { return duration_s_; }
  /// Log stamp at which the time line is 0.
  [[nodiscard]] rt::Nanoseconds start() const { return start_; }

  /// Goes to the beginning of the chunk that contains the time `at_s` (clamped to the recording).
  /// @returns the time of that beginning [s]
  double Seek(double at_s);
  /// Reads the next message (RecordingStream::Next).
  [[nodiscard]] tl::expected<io::RecordedTopic, std::string> Next() { return stream_.Next(); }
  /// The stream with the message that was read last.
  [[nodiscard]] const io::RecordingStream& message() const { return stream_; }
  /// Time of a log stamp on the time line [s].
  [[nodiscard]] double At(rt::Nanoseconds stamp) const { return rt::ToSeconds(stamp - start_); }

 private:
  RecordingTimeline(io::RecordingStream stream, std::vector<io::McapChunkPlace> chunks);

  io::RecordingStream stream_;
  std::vector<io::McapChunkPlace> chunks_;  // the chunks by time
  rt::Nanoseconds start_{0};
  double duration_s_{0.0};
};

}  // namespace osteon::session
