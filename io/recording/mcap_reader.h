#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::io {

/// Channel of a message.
struct McapChannel {
  std::uint16_t id{0};
  std::string topic, message_encoding;
  /// For protobuf: a FileDescriptorSet. Empty if the channel has no schema.
  std::string schema_name, schema_encoding, schema;

  friend bool operator==(const McapChannel&, const McapChannel&) = default;
};

/// One message as it lies in the file.
struct McapMessage {
  const McapChannel* channel{nullptr};  ///< valid as long as the reader
  std::uint64_t log_time_ns{0};
  std::span<const char> bytes;  ///< valid until the next call of Next
  bool checked{true};           ///< false: from a truncated chunk, whose CRC cannot be checked
};

/// Where a chunk of messages lies in a file, and the log times in it.
struct McapChunkPlace {
  std::uint64_t offset{0};
  std::uint64_t first_ns{0}, last_ns{0};
};

/// A skipped part of a file.
struct McapDamage {
  std::uint64_t offset{0}, bytes{0};
  std::string reason;
};

/// Reads the messages of an MCAP file in their order in the file; only one chunk at a time is in memory.
///
/// Files of any writer are accepted: chunks without compression, or with zstd or lz4; channels with or
/// without a schema. Records other than schemas, channels and messages are skipped. No byte is trusted: a
/// length beyond the file ends the file (it is torn), never the program. The complete messages of a truncated
/// chunk are still returned, unchecked; those of a compressed one as far as it can be unpacked
/// (mcap_compression.h).
class McapReader {
 public:
  enum class OnDamage {
    kRefuse,  ///< an error that names the byte
    kSkip,    ///< goes on with the next sound chunk, and notes what was skipped
  };

  /// The error names the file and the reason: cannot be read, or not MCAP.
  [[nodiscard]] static tl::expected<McapReader, std::string> Open(const std::filesystem::path& path,
                                                                  OnDamage on_damage = OnDamage::kRefuse);

  /// Reads the next message. False at the file's end. The error names file, byte and reason; it is final.
  [[nodiscard]] tl::expected<bool, std::string> Next(McapMessage& message);

  /// Reads where the chunks lie, by their heads, up to the first byte that is no record, and unpacks those in
  /// which a channel is first used: some milliseconds for an hour's recording. Then goes back to the
  /// beginning.
  [[nodiscard]] std::vector<McapChunkPlace> FindChunks();
  /// Goes on with the record at an offset that FindChunks named. From then on the CRC of the whole file is
  /// not checked, each chunk's own is.
  void SeekTo(std::uint64_t offset);

  /// Valid at the end: closing magic and everything before it were present, and nothing follows it.
  [[nodiscard]] bool complete() const { return complete_ && offset_ == size_; }
  /// Valid at the end: the closing magic was present; bytes up to file_bytes() follow it.
  [[nodiscard]] bool closed() const { return closed_; }
  /// Bytes up to the end, or up to the first unusable byte: the rest of a torn file. A truncated compressed
  /// chunk counts as the rest, although messages of it may be returned.
  [[nodiscard]] std::uint64_t read_bytes() const { return offset_; }
  [[nodiscard]] std::uint64_t file_bytes() const { return size_; }
  /// Offset of the last message's record, or of its chunk.
  [[nodiscard]] std::uint64_t message_offset() const { return records_offset_; }
  [[nodiscard]] const std::vector<McapDamage>& damage() const { return damage_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// The program that wrote the file, from the header.
  [[nodiscard]] const std::string& library() const { return library_; }
  /// "file: byte N: reason" of the last message.
  [[nodiscard]] std::string ErrorAt(const std::string& reason) const;

 private:
  struct Schema {
    std::string name, encoding, data;
  };

  McapReader(const std::filesystem::path& path, std::ifstream file, std::uint64_t size, OnDamage on_damage)
      : path_(path), file_(std::move(file)), size_(size), on_damage_(on_damage) {}

  [[nodiscard]] std::string ReadRecord();
  // Handles a record of the file by its opcode. Like all functions here that return a string: empty, or the
  // error.
  [[nodiscard]] std::string HandleRecord(std::uint8_t opcode, std::span<const char> content);
  // Unpacks a chunk into records_.
  [[nodiscard]] std::string UnpackChunk(std::span<const char> content);
  void UnpackTornChunk();
  [[nodiscard]] std::string ReadChunkRecord(McapMessage& message, bool& found);
  [[nodiscard]] std::string ReadSchema(std::span<const char> content);
  [[nodiscard]] std::string ReadChannel(std::span<const char> content);
  [[nodiscard]] std::string ReadClosingMagic();
  void ReadSummary();
  // Reads the schemas and channels of the chunk at an offset in the file.
  void ReadChannelsOfChunk(std::uint64_t chunk);
  [[nodiscard]] bool SkipToNextChunk(const std::string& reason);
  // Whether the record at `offset`, of `length` bytes, is a chunk that unpacks and matches its CRC.
  [[nodiscard]] bool IsSoundChunk(std::uint64_t offset, std::uint64_t length);
  [[nodiscard]] bool IsZeroToTheEnd();
  // Reads bytes of the file. False if there are not that many.
  [[nodiscard]] bool Read(std::uint64_t offset, std::uint64_t length, std::string& bytes);

  std::filesystem::path path_;
  std::ifstream file_;
  std::uint64_t size_;
  OnDamage on_damage_;
  std::string library_;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, McapChannel> channels_;  // nodes keep their addresses
  std::vector<McapDamage> damage_;

  std::uint64_t offset_{0};  // of the next record
  std::uint32_t crc_{0};     // of everything before it
  bool sought_{false};       // SeekTo was called: crc_ is of a part
  bool has_header_{false}, data_ended_{false}, ended_{false}, complete_{false}, closed_{false};

  // the records being handed out: a chunk's, or a single one outside any chunk
  std::string records_;
  std::uint64_t records_offset_{0};   // offset in the file of the record that contains them
  std::uint64_t at_{0}, last_at_{0};  // positions in records_ of the next and of the last record
  std::uint64_t torn_records_{0};     // offset in the file, if a torn chunk is not compressed; else 0
  bool in_chunk_{false};              // records_ is a chunk's
  bool torn_{false};                  // of a chunk that the end of the file cuts off
};

}  // namespace osteon::io
