#include "io/recording/recording_reader.h"

#include <zlib.h>

#include <array>
#include <cerrno>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>

#include "io/recording/mcap.h"

namespace osteon::io {
namespace {

constexpr std::uint64_t kMaxRecord = 64u << 20;  // [bytes] ours have at most a configuration's text

std::uint32_t Crc(std::uint32_t crc, std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(crc, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

// Little-endian fields of one record. Reading past the end gives zeros and is remembered.
class Cursor {
 public:
  explicit Cursor(std::span<const char> bytes) : rest_(bytes) {}

  template <class T>
  T Int() {
    T value = 0;
    const std::span<const char> bytes = Take(sizeof(T));
    for (std::size_t i = 0; i < bytes.size(); ++i)
      value = static_cast<T>(value |
                             static_cast<T>(static_cast<T>(static_cast<unsigned char>(bytes[i])) << (8 * i)));
    return value;
  }
  std::string_view String() {
    const std::span<const char> bytes = Take(Int<std::uint32_t>());
    return {bytes.data(), bytes.size()};
  }
  [[nodiscard]] std::span<const char> rest() const { return rest_; }
  [[nodiscard]] bool ok() const { return ok_; }

 private:
  std::span<const char> Take(std::size_t size) {
    if (size > rest_.size()) {
      ok_ = false;
      return {};
    }
    const std::span<const char> taken = rest_.first(size);
    rest_ = rest_.subspan(size);
    return taken;
  }

  std::span<const char> rest_;
  bool ok_{true};
};

enum class Topic : std::uint8_t { kUnknown, kSession, kTick, kFrame, kEvent };

Topic TopicOf(std::string_view message_type) {
  if (message_type == "osteon.Session") return Topic::kSession;
  if (message_type == "osteon.Tick") return Topic::kTick;
  if (message_type == "osteon.Frame") return Topic::kFrame;
  if (message_type == "osteon.Event") return Topic::kEvent;
  return Topic::kUnknown;
}

// One pass over the file. Each On… returns an empty string, or the reason of an error.
class Pass {
 public:
  std::string OnRecord(std::uint8_t opcode, std::span<const char> content, std::uint32_t crc_before) {
    if (!has_header_ && opcode != mcap::kHeader) return "the first record is not a header";
    switch (opcode) {
      case 0:
        return "opcode 0 is not a record";
      case mcap::kHeader:
        has_header_ = true;
        return {};
      case mcap::kSchema:
        return data_ended_ ? "" : OnSchema(Cursor(content));
      case mcap::kChannel:
        return data_ended_ ? "" : OnChannel(Cursor(content));
      case mcap::kMessage:
        return data_ended_ ? "message after the end of data" : OnMessage(Cursor(content));
      case mcap::kChunk:
        return data_ended_ ? "chunk after the end of data" : OnChunk(Cursor(content));
      case mcap::kDataEnd:
        return OnDataEnd(Cursor(content), crc_before);
      case mcap::kFooter:
        return OnFooter(content);
      default:
        return {};
    }
  }

  Recording recording;
  [[nodiscard]] bool footed() const { return footed_; }
  [[nodiscard]] bool has_session() const { return has_session_; }

 private:
  std::string OnSchema(Cursor cursor) {
    const auto id = cursor.Int<std::uint16_t>();
    const std::string_view name = cursor.String();
    const std::string_view encoding = cursor.String();
    if (!cursor.ok()) return "schema is cut off";
    schemas_[id] = encoding == "protobuf" ? TopicOf(name) : Topic::kUnknown;
    return {};
  }

  std::string OnChannel(Cursor cursor) {
    const auto id = cursor.Int<std::uint16_t>();
    const auto schema = cursor.Int<std::uint16_t>();
    if (!cursor.ok()) return "channel is cut off";
    const auto found = schemas_.find(schema);
    if (found == schemas_.end())
      return "channel " + std::to_string(id) + " names schema " + std::to_string(schema) +
             ", which is not in the file";
    channels_[id] = found->second;
    return {};
  }

  std::string OnMessage(Cursor cursor) {
    const auto id = cursor.Int<std::uint16_t>();
    cursor.Int<std::uint32_t>();  // sequence
    cursor.Int<std::uint64_t>();  // log time
    cursor.Int<std::uint64_t>();  // publish time
    if (!cursor.ok()) return "message is cut off";
    const auto found = channels_.find(id);
    if (found == channels_.end())
      return "message of channel " + std::to_string(id) + ", which is not in the file";
    switch (found->second) {
      case Topic::kSession:
        has_session_ = true;
        return Decode(cursor.rest(), recording.session);
      case Topic::kTick:
        return Decode(cursor.rest(), recording.ticks.emplace_back());
      case Topic::kFrame:
        return Decode(cursor.rest(), recording.frames.emplace_back());
      case Topic::kEvent:
        return Decode(cursor.rest(), recording.events.emplace_back());
      case Topic::kUnknown:
        break;
    }
    return {};
  }

  std::string OnChunk(Cursor cursor) {
    cursor.Int<std::uint64_t>();  // first time
    cursor.Int<std::uint64_t>();  // last time
    cursor.Int<std::uint64_t>();  // size
    const auto expected = cursor.Int<std::uint32_t>();
    const std::string_view compression = cursor.String();
    const auto size = cursor.Int<std::uint64_t>();
    if (!cursor.ok() || size != cursor.rest().size()) return "chunk is cut off";
    if (!compression.empty())
      return "chunk compressed with '" + std::string(compression) + "', accepted: not compressed";
    const std::string_view records(cursor.rest().data(), cursor.rest().size());
    if (expected != 0 && expected != Crc(0, records))
      return "the chunk does not match its CRC: the file was changed";

    std::size_t at = 0;
    while (at < records.size()) {
      const auto error = [&](const std::string& reason) {
        return "in the chunk's byte " + std::to_string(at) + ": " + reason;
      };
      Cursor head(cursor.rest().subspan(at));
      const auto opcode = head.Int<std::uint8_t>();
      const auto length = head.Int<std::uint64_t>();
      if (!head.ok() || length > head.rest().size()) return error("record is cut off");
      if (opcode != mcap::kSchema && opcode != mcap::kChannel && opcode != mcap::kMessage)
        return error("a record of opcode " + std::to_string(opcode) + " has no place in a chunk");
      const std::string reason = OnRecord(opcode, head.rest().first(length), 0);
      if (!reason.empty()) return error(reason);
      at += mcap::kRecordHead + length;
    }
    return {};
  }

  std::string OnDataEnd(Cursor cursor, std::uint32_t crc) {
    const auto expected = cursor.Int<std::uint32_t>();
    if (!cursor.ok()) return "end of data is cut off";
    data_ended_ = true;
    return expected != 0 && expected != crc ? "the data does not match its CRC: the file was changed" : "";
  }

  std::string OnFooter(std::span<const char> content) {
    if (content.size() < 20) return "footer is cut off";
    if (!data_ended_) return "footer before the end of data";
    footed_ = true;
    return {};
  }

  std::map<std::uint16_t, Topic> schemas_, channels_;
  bool has_header_{false}, has_session_{false}, data_ended_{false}, footed_{false};
};

}  // namespace

tl::expected<Recording, std::string> ReadRecording(const std::filesystem::path& path) {
  std::uint64_t offset = 0;
  const auto error = [&](const std::string& reason) {
    return tl::unexpected(path.string() + ": byte " + std::to_string(offset) + ": " + reason);
  };
  std::ifstream file(path, std::ios::binary);
  std::error_code no_size;
  const std::uint64_t size = std::filesystem::file_size(path, no_size);
  if (!file || no_size)
    return tl::unexpected(path.string() + ": cannot read: " +
                          (no_size ? no_size.message() : std::generic_category().message(errno)));

  std::array<char, mcap::kMagic.size()> magic{};
  file.read(magic.data(), magic.size());
  if (!file || std::string_view(magic.data(), magic.size()) != mcap::kMagic)
    return error("not an MCAP file (its first 8 bytes are not the magic)");

  std::uint32_t crc = Crc(0, mcap::kMagic);
  offset = magic.size();
  Pass pass;
  std::string record;
  while (!pass.footed() && size - offset >= mcap::kRecordHead) {
    record.resize(mcap::kRecordHead);
    file.read(record.data(), static_cast<std::streamsize>(record.size()));
    Cursor head(record);
    const auto opcode = head.Int<std::uint8_t>();
    const auto length = head.Int<std::uint64_t>();
    if (length > kMaxRecord)
      return error("record of " + std::to_string(length) + " bytes, accepted up to " +
                   std::to_string(kMaxRecord));
    if (length > size - offset - mcap::kRecordHead) break;  // torn
    record.resize(mcap::kRecordHead + length);
    file.read(record.data() + mcap::kRecordHead, static_cast<std::streamsize>(length));
    if (!file) return error("cannot read on");
    const std::string reason =
        pass.OnRecord(opcode, std::span<const char>(record).subspan(mcap::kRecordHead), crc);
    if (!reason.empty()) return error(reason);
    crc = Crc(crc, record);
    offset += record.size();
  }

  if (pass.footed()) {
    file.read(magic.data(), magic.size());
    if (file && std::string_view(magic.data(), magic.size()) != mcap::kMagic)
      return error("the closing magic is damaged");
    if (file) offset += magic.size();
    pass.recording.complete = static_cast<bool>(file);
  }
  if (!pass.has_session()) return error("no osteon.Session in it: not a recording of this program");
  pass.recording.read_bytes = offset;
  return std::move(pass.recording);
}

}  // namespace osteon::io
