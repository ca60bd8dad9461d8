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

/// One message as it is stored in the file.
struct McapMessage {
  const McapChannel* channel{nullptr};  ///< valid as long as the reader
  std::uint64_t log_time_ns{0};
  std::span<const char> bytes;  ///< valid until the next call of Next
  bool checked{true};           ///< false: the message is from a truncated chunk, whose CRC cannot be checked
};

/// Offset of a chunk of messages in a file, and the chunk's first and last log time.
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
/// without a schema. Records other than schemas, channels and messages are skipped. Every length is checked:
/// a record that is longer than the rest of the file is treated as the end of a torn file. The complete
/// messages of a truncated chunk are still returned, without a CRC check. If the truncated chunk is
/// compressed, only the messages in its complete blocks are returned (mcap_compression.h).
class McapReader {
 public:
  enum class OnDamage {
    kRefuse,  ///< Next returns an error that names the byte
    kSkip,    ///< Next continues with the next sound chunk, and adds the skipped part to damage()
  };

  /// Opens a file. The error names the file and the reason: the file cannot be read, or is not MCAP.
  [[nodiscard]] static tl::expected<McapReader, std::string> Open(const std::filesystem::path& path,
                                                                  OnDamage on_damage = OnDamage::kRefuse);

  /// Reads the next message. False at the file's end. The error names file, byte and reason. After an error
  /// nothing more can be read.
  [[nodiscard]] tl::expected<bool, std::string> Next(McapMessage& message);

  /// Finds the chunks by reading their heads, up to the first byte that does not begin a record. Also unpacks
  /// the chunks in which a channel is first used. This takes some milliseconds for an hour's recording.
  /// Reading then continues from the beginning.
  [[nodiscard]] std::vector<McapChunkPlace> FindChunks();
  /// Continues with the record at an offset that FindChunks returned. From then on the CRC of the whole file
  /// is not checked; each chunk's own CRC still is.
  void SeekTo(std::uint64_t offset);

  /// Valid after the last message: the closing magic and everything before it were present, and nothing
  /// follows the magic.
  [[nodiscard]] bool complete() const { return complete_ && offset_ == size_; }
  /// Valid after the last message: the closing magic was present, although further bytes, up to file_bytes(),
  /// may follow it.
  [[nodiscard]] bool closed() const { return closed_; }
  /// Number of bytes that were read: up to the file's end, or, in a torn file, up to the first unusable byte.
  /// A truncated compressed chunk counts as unusable, although some of its messages may be returned.
  [[nodiscard]] std::uint64_t read_bytes() const { return offset_; }
  [[nodiscard]] std::uint64_t file_bytes() const { return size_; }
  /// File offset of the last message's record, or, if the message is in a chunk, of that chunk.
  [[nodiscard]] std::uint64_t message_offset() const { return records_offset_; }
  [[nodiscard]] const std::vector<McapDamage>& damage() const { return damage_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// The program that wrote the file, from the header.
  [[nodiscard]] const std::string& library() const { return library_; }
  /// An error text "file: byte N: reason", with the place of the last message.
  [[nodiscard]] std::string ErrorAt(const std::string& reason) const;

 private:
  struct Schema {
    std::string name, encoding, data;
  };

  McapReader(const std::filesystem::path& path, std::ifstream file, std::uint64_t size, OnDamage on_damage)
      : path_(path), file_(std::move(file)), size_(size), on_damage_(on_damage) {}

  [[nodiscard]] std::string ReadRecord();
  // Handles a record of the file by its opcode. All functions here that return a string return the error, or
  // an empty string on success.
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
  // Reads `length` bytes of the file. False if the file has fewer.
  [[nodiscard]] bool Read(std::uint64_t offset, std::uint64_t length, std::string& bytes);

  std::filesystem::path path_;
  std::ifstream file_;
  std::uint64_t size_;
  OnDamage on_damage_;
  std::string library_;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, McapChannel> channels_;  // a map, because messages point to its elements
  std::vector<McapDamage> damage_;

  std::uint64_t offset_{0};  // file offset of the next record
  std::uint32_t crc_{0};     // CRC-32 of all bytes before offset_
  bool sought_{false};       // SeekTo was called, so crc_ covers only a part
  bool has_header_{false}, data_ended_{false}, ended_{false}, complete_{false}, closed_{false};

  // the records whose messages Next returns: those of one chunk, or a single record outside any chunk
  std::string records_;
  std::uint64_t records_offset_{0};   // file offset of the record that contains records_
  std::uint64_t at_{0}, last_at_{0};  // positions in records_ of the next record and of the one read last
  std::uint64_t torn_records_{0};     // file offset of the records of a torn, uncompressed chunk; else 0
  bool in_chunk_{false};              // records_ is the content of a chunk
  bool torn_{false};                  // that chunk is truncated by the end of the file
};

}  // namespace osteon::io
