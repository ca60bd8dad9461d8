#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "io/recording/mcap_compression.h"

namespace osteon::io {

struct McapWriterParams {
  /// Bytes of records, before compression, at which a chunk ends: about 0.2 s of ticks and frames at 1 kHz
  /// each.
  std::size_t chunk_bytes{256u << 10};
  bool compress{true};  ///< true: chunks are compressed by zstd
};

/// Writes one MCAP file, front to back. The same calls give the same bytes with the same libzstd: the file
/// contains no time of writing, no address, and no version except the given string. After the first failed
/// write nothing more is written, lost messages are counted, and Finish reports the error.
class McapWriter {
 public:
  /// Longest time between the first and the last message of a chunk, by their log times.
  static constexpr std::int64_t kChunkTime_ns = 250'000'000;

  /// Creates or overwrites the file, which is locked (flock) while it is open. If another process is writing
  /// the file, it is refused and left unchanged. The error names the path and the system's reason.
  [[nodiscard]] static tl::expected<McapWriter, std::string> Create(const std::filesystem::path& path,
                                                                    std::string_view library,
                                                                    const McapWriterParams& params = {});

  /// Adds a topic. The schema of protobuf messages is a serialised FileDescriptorSet that contains
  /// `message_type`.
  /// @returns the channel for Write.
  std::uint16_t AddChannel(std::string_view topic, std::string_view message_type, std::string_view schema,
                           std::string_view schema_encoding = "protobuf",
                           std::string_view message_encoding = "protobuf");

  /// Writes one message. Its log time and publish time are `stamp_ns`. A negative stamp is written as 0,
  /// because MCAP has no negative times.
  void Write(std::uint16_t channel, std::int64_t stamp_ns, std::string_view bytes);

  /// Ends the present chunk, so that the next Flush passes every message written so far to the system.
  void EndChunk();

  /// Passes the complete chunks to the system, so that they outlive this process.
  void Flush();

  /// Brings flushed data to the disk itself (fdatasync), so that it outlives the machine, and checks that the
  /// file is still at its path. May wait for the disk. May be called by any thread while another thread
  /// writes, but neither during nor after Finish. @returns an empty string, or the error, with the path.
  [[nodiscard]] std::string Sync() const;

  /// Writes summary and footer and closes the file. If `to_disk` is set, also waits until the file is on the
  /// disk. @returns the file's size in bytes. The error names the path and the reason: it could not be
  /// written, or it is no longer at its path.
  tl::expected<std::uint64_t, std::string> Finish(bool to_disk = false);

  [[nodiscard]] bool failed() const { return !error_.empty(); }
  /// The first error, with the path; empty if nothing failed.
  [[nodiscard]] const std::string& error() const { return error_; }
  /// messages(): number of accepted messages. lost_messages(): how many of them could not be written.
  [[nodiscard]] std::uint64_t messages() const { return times_.messages; }
  [[nodiscard]] std::uint64_t lost_messages() const { return lost_; }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  struct Channel {
    std::string schema_record, channel_record;
    std::uint32_t messages{0};
    std::string chunk_index;  // time and offset of each of this channel's messages in the present chunk
  };
  // Number of some messages, and their first and last log time.
  struct TimeRange {
    std::uint64_t first_ns{0}, last_ns{0}, messages{0};
    void Add(std::uint64_t time_ns);
  };

  McapWriter(const std::filesystem::path& path, std::FILE* file, const McapWriterParams& params)
      : path_(path), file_(file), params_(params) {}
  void PutMessageIndexes(std::string& offsets);
  void WriteBytes(std::string_view bytes);
  // Keeps the error of a failed write. @param error  errno
  void Fail(int error);
  [[nodiscard]] std::string ValidateStillAtPath() const;

  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Close> file_;
  McapWriterParams params_;
  mcap::ZstdCompressor compressor_;
  std::vector<Channel> channels_;
  std::string chunk_;          // records of the present chunk
  TimeRange chunk_times_;      // times of the present chunk's messages
  std::string chunk_indexes_;  // ChunkIndex records so far, for the summary
  std::uint32_t chunks_{0};
  std::uint64_t lost_{0};  // messages that could not be written
  TimeRange times_;        // times and number of all messages
  std::uint64_t size_{0};  // bytes written so far
  std::uint32_t crc_{0};   // CRC-32 of all bytes so far
  std::string error_;
};

}  // namespace osteon::io
