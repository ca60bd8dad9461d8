#include "io/recording/mcap_reader.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <set>
#include <system_error>

#include "io/recording/mcap_bytes.h"
#include "io/recording/mcap_compression.h"

namespace osteon::io {
namespace {

using mcap::Crc;
using mcap::Cursor;

// [bytes] A longer record counts as damage. The longest record that this project writes holds a
// configuration's files.
constexpr std::uint64_t kMaxRecord = 64u << 20;
// Bytes of an uncompressed chunk before its records: first and last time, unpacked size, CRC, length of the
// (empty) compression name, length of the records.
constexpr std::uint64_t kChunkHead = 8 + 8 + 8 + 4 + 4 + 8;
// Bytes of the footer record: head, start of the summary, start of the summary offsets, CRC.
constexpr std::uint64_t kFooterRecord = mcap::kRecordHead + 8 + 8 + 4;

std::string_view View(std::span<const char> bytes) { return {bytes.data(), bytes.size()}; }

}  // namespace

tl::expected<McapReader, std::string> McapReader::Open(const std::filesystem::path& path,
                                                       OnDamage on_damage) {
  std::ifstream file(path, std::ios::binary);
  std::error_code no_size;
  const std::uint64_t size = std::filesystem::file_size(path, no_size);
  if (!file || no_size)
    return tl::unexpected(path.string() + ": cannot read: " +
                          (no_size ? no_size.message() : std::generic_category().message(errno)));
  McapReader reader(path, std::move(file), size, on_damage);
  std::string magic;
  if (!reader.Read(0, mcap::kMagic.size(), magic) || magic != mcap::kMagic)
    return tl::unexpected(path.string() + ": byte 0: not an MCAP file (its first 8 bytes are not the magic)");
  reader.crc_ = Crc(0, magic);
  reader.offset_ = magic.size();
  if (on_damage == OnDamage::kSkip) reader.ReadSummary();
  if (const std::string reason = reader.ReadRecord(); !reason.empty())  // the header
    return tl::unexpected(path.string() + ": byte " + std::to_string(reader.offset_) + ": " + reason);
  return reader;
}

tl::expected<bool, std::string> McapReader::Next(McapMessage& message) {
  for (;;) {
    while (at_ < records_.size()) {
      bool found = false;
      last_at_ = at_;
      const std::string reason = ReadChunkRecord(message, found);
      if (found) return true;
      if (reason.empty()) continue;
      if (!torn_ && on_damage_ == OnDamage::kRefuse) return tl::unexpected(ErrorAt(reason));
      if (!torn_) damage_.push_back({records_offset_, records_.size() - at_, reason});
      records_.resize(at_);
    }
    // a torn, uncompressed chunk counts as read up to the end of its last complete record
    if (torn_ && at_ > 0 && torn_records_ > 0) offset_ = torn_records_ + at_;
    torn_ = false;
    records_.clear();
    at_ = 0;
    if (ended_) return false;
    if (const std::string reason = ReadRecord(); !reason.empty())
      return tl::unexpected(path_.string() + ": byte " + std::to_string(offset_) + ": " + reason);
  }
}

std::vector<McapChunkPlace> McapReader::FindChunks() {
  constexpr std::uint64_t kTimes = 16;  // bytes of the first and last time, at the beginning of a chunk
  const std::uint64_t start = mcap::kMagic.size();
  std::vector<McapChunkPlace> chunks;
  std::set<std::uint16_t> used;  // channels found so far
  std::string head;
  for (std::uint64_t at = start; size_ - at >= mcap::kRecordHead + kTimes;) {
    if (!Read(at, mcap::kRecordHead + kTimes, head)) break;
    Cursor cursor(head);
    const auto opcode = cursor.Int<std::uint8_t>();
    const auto length = cursor.Int<std::uint64_t>();
    if (opcode == mcap::kDataEnd || opcode == 0 || length > size_ - at - mcap::kRecordHead) break;
    if (opcode == mcap::kChunk) {
      const auto first = cursor.Int<std::uint64_t>();
      chunks.push_back({.offset = at, .first_ns = first, .last_ns = cursor.Int<std::uint64_t>()});
    }
    // A chunk is followed by an index for each of its channels. If a channel has not been used before, that
    // chunk contains its description, so read it there.
    if (opcode == mcap::kMessageIndex && !chunks.empty() && used.insert(cursor.Int<std::uint16_t>()).second)
      ReadChannelsOfChunk(chunks.back().offset);
    at += mcap::kRecordHead + length;
  }
  SeekTo(start);
  return chunks;
}

void McapReader::ReadChannelsOfChunk(std::uint64_t chunk) {
  SeekTo(chunk);
  if (!ReadRecord().empty()) return;  // a damaged chunk: reading it later reports the error
  McapMessage message;
  bool found = false;
  while (at_ < records_.size() && ReadChunkRecord(message, found).empty()) {
  }
}

void McapReader::SeekTo(std::uint64_t offset) {
  offset_ = offset;
  records_.clear();
  at_ = 0;
  in_chunk_ = torn_ = false;
  data_ended_ = ended_ = complete_ = closed_ = false;
  sought_ = true;
}

std::string McapReader::ErrorAt(const std::string& reason) const {
  return path_.string() + ": byte " + std::to_string(records_offset_) + ": " +
         (in_chunk_ ? "in the chunk's byte " + std::to_string(last_at_) + ": " : "") + reason;
}

// Reads the file's next record, and puts its messages into records_. Returns an empty string, or the error.
std::string McapReader::ReadRecord() {
  std::string record;
  const std::uint64_t rest = size_ - offset_;
  if (rest < mcap::kRecordHead || !Read(offset_, mcap::kRecordHead, record)) {
    ended_ = true;
    return {};
  }
  Cursor head(record);
  const auto opcode = head.Int<std::uint8_t>();
  const auto length = head.Int<std::uint64_t>();
  const bool skip = on_damage_ == OnDamage::kSkip;
  if (opcode == 0 && IsZeroToTheEnd()) {  // space that was not yet filled when the power failed
    ended_ = true;
    return {};
  }
  std::string reason;
  if (length > kMaxRecord) {
    reason = "record of " + std::to_string(length) + " bytes, accepted up to " + std::to_string(kMaxRecord);
  } else if (length > rest - mcap::kRecordHead) {
    // Either the file is truncated here, or this length is damaged and sound chunks follow.
    if (skip && SkipToNextChunk("record of " + std::to_string(length) + " bytes, more than the file has"))
      return {};
    if (opcode == mcap::kChunk) UnpackTornChunk();
    ended_ = true;
    return {};
  } else if (!Read(offset_, mcap::kRecordHead + length, record)) {
    return "cannot read on";
  } else {
    records_offset_ = offset_;
    reason = HandleRecord(opcode, std::span<const char>(record).subspan(mcap::kRecordHead));
  }
  if (!reason.empty()) {
    if (!skip) return reason;
    if (!SkipToNextChunk(reason)) {
      damage_.push_back({offset_, size_ - offset_, reason});
      ended_ = true;
    }
    return {};
  }
  crc_ = Crc(crc_, record);
  offset_ += record.size();
  if (ended_) return ReadClosingMagic();
  return {};
}

std::string McapReader::HandleRecord(std::uint8_t opcode, std::span<const char> content) {
  if (!has_header_ && opcode != mcap::kHeader && on_damage_ == OnDamage::kRefuse)
    return "the first record is not a header";
  Cursor cursor(content);
  switch (opcode) {
    case 0:
      return "opcode 0 is not a record";
    case mcap::kHeader:
      has_header_ = true;
      cursor.String();
      library_ = cursor.String();
      return {};
    case mcap::kSchema:
    case mcap::kChannel:
      // these belong to the summary, which repeats schemas and channels of the chunks
      if (data_ended_) return {};
      [[fallthrough]];
    case mcap::kMessage:
      if (data_ended_) return "message after the end of data";
      records_.clear();
      mcap::AppendRecord(records_, static_cast<mcap::Opcode>(opcode), View(content));
      at_ = 0;
      in_chunk_ = false;
      return {};
    case mcap::kChunk:
      return data_ended_ ? "chunk after the end of data" : UnpackChunk(content);
    case mcap::kDataEnd: {
      const auto expected = cursor.Int<std::uint32_t>();
      if (!cursor.ok()) return "end of data is cut off";
      data_ended_ = true;
      // with skipped parts the CRC of the whole data cannot match
      if (on_damage_ == OnDamage::kSkip && !damage_.empty()) return {};
      return !sought_ && expected != 0 && expected != crc_
                 ? "the data does not match its CRC: the file was changed"
                 : "";
    }
    case mcap::kFooter:
      if (content.size() < 20) return "footer is cut off";
      if (!data_ended_) return "footer before the end of data";
      ended_ = true;
      return {};
    default:
      return {};
  }
}

std::string McapReader::UnpackChunk(std::span<const char> content) {
  Cursor cursor(content);
  cursor.Int<std::uint64_t>();  // first time
  cursor.Int<std::uint64_t>();  // last time
  const auto unpacked_size = cursor.Int<std::uint64_t>();
  const auto expected = cursor.Int<std::uint32_t>();
  const std::string_view compression = cursor.String();
  const auto size = cursor.Int<std::uint64_t>();
  if (!cursor.ok() || size != cursor.rest().size()) return "chunk is cut off";
  auto records = mcap::Decompress(compression, cursor.rest(), unpacked_size);
  if (!records) return records.error();
  if (expected != 0 && expected != Crc(0, *records))
    return "the chunk does not match its CRC: the file was changed";
  records_ = std::move(*records);
  at_ = 0;
  in_chunk_ = true;
  return {};
}

// Reads the existing part of a chunk that was being written when the process died.
void McapReader::UnpackTornChunk() {
  std::string content;
  const std::uint64_t start = offset_ + mcap::kRecordHead;
  if (size_ - start <= kChunkHead || !Read(start, size_ - start, content)) return;
  Cursor cursor(content);
  cursor.Int<std::uint64_t>();
  cursor.Int<std::uint64_t>();
  const auto unpacked_size = cursor.Int<std::uint64_t>();
  cursor.Int<std::uint32_t>();
  const std::string_view compression = cursor.String();
  const auto size = cursor.Int<std::uint64_t>();
  if (!cursor.ok()) return;
  records_ = mcap::DecompressTorn(
      compression, cursor.rest().first(std::min<std::uint64_t>(size, cursor.rest().size())), unpacked_size);
  at_ = 0;
  records_offset_ = offset_;
  torn_records_ = compression.empty() ? start + kChunkHead : 0;
  in_chunk_ = torn_ = true;
}

// Reads one record of the present chunk. Returns an empty string, or the error. After an error at_ is still
// the start of the invalid record.
std::string McapReader::ReadChunkRecord(McapMessage& message, bool& found) {
  Cursor head(std::span<const char>(records_).subspan(at_));
  const auto opcode = head.Int<std::uint8_t>();
  const auto length = head.Int<std::uint64_t>();
  if (!head.ok() || length > head.rest().size()) return "record is cut off";
  const std::span<const char> content = head.rest().first(length);
  Cursor cursor(content);
  if (opcode == mcap::kSchema) {
    if (const std::string reason = ReadSchema(content); !reason.empty()) return reason;
  } else if (opcode == mcap::kChannel) {
    if (const std::string reason = ReadChannel(content); !reason.empty()) return reason;
  } else if (opcode == mcap::kMessage) {
    const auto id = cursor.Int<std::uint16_t>();
    cursor.Int<std::uint32_t>();  // sequence
    message.log_time_ns = cursor.Int<std::uint64_t>();
    cursor.Int<std::uint64_t>();  // publish time
    if (!cursor.ok()) return "message is cut off";
    const auto channel = channels_.find(id);
    if (channel == channels_.end())
      return "message of channel " + std::to_string(id) + ", which is not in the file";
    message.channel = &channel->second;
    message.bytes = cursor.rest();
    message.checked = !torn_;
    found = true;
  } else {
    return "a record of opcode " + std::to_string(opcode) + " has no place in a chunk";
  }
  at_ += mcap::kRecordHead + length;
  return {};
}

std::string McapReader::ReadSchema(std::span<const char> content) {
  Cursor cursor(content);
  const auto id = cursor.Int<std::uint16_t>();
  Schema schema;
  schema.name = cursor.String();
  schema.encoding = cursor.String();
  schema.data = cursor.String();
  if (!cursor.ok()) return "schema is cut off";
  schemas_[id] = std::move(schema);
  return {};
}

std::string McapReader::ReadChannel(std::span<const char> content) {
  Cursor cursor(content);
  const auto id = cursor.Int<std::uint16_t>();
  const auto schema = cursor.Int<std::uint16_t>();
  const std::string_view topic = cursor.String(), encoding = cursor.String();
  if (!cursor.ok()) return "channel is cut off";
  static const Schema kNoSchema;
  const auto found = schemas_.find(schema);
  if (found == schemas_.end() && schema != 0)  // 0: a channel without a schema, e.g. of JSON messages
    return "channel " + std::to_string(id) + " names schema " + std::to_string(schema) +
           ", which is not in the file";
  const Schema& described = schema == 0 ? kNoSchema : found->second;
  channels_[id] = {.id = id,
                   .topic = std::string(topic),
                   .message_encoding = std::string(encoding),
                   .schema_name = described.name,
                   .schema_encoding = described.encoding,
                   .schema = described.data};
  return {};
}

std::string McapReader::ReadClosingMagic() {
  std::string magic;
  if (size_ - offset_ < mcap::kMagic.size() || !Read(offset_, mcap::kMagic.size(), magic)) return {};
  if (magic != mcap::kMagic) return on_damage_ == OnDamage::kRefuse ? "the closing magic is damaged" : "";
  offset_ += magic.size();
  closed_ = true;
  complete_ = damage_.empty();
  return {};
}

// Reads the schemas and channels that a whole file repeats at its end, so that a file whose first chunk is
// damaged can still be read.
void McapReader::ReadSummary() {
  std::string footer, record;
  const std::uint64_t tail = kFooterRecord + mcap::kMagic.size();
  if (size_ < tail || !Read(size_ - tail, kFooterRecord, footer) || footer[0] != mcap::kFooter) return;
  std::uint64_t at = Cursor(std::span<const char>(footer).subspan(mcap::kRecordHead)).Int<std::uint64_t>();
  while (at >= offset_ && at < size_ - tail && size_ - tail - at >= mcap::kRecordHead &&
         Read(at, mcap::kRecordHead, record)) {
    Cursor head(record);
    const auto opcode = head.Int<std::uint8_t>();
    const auto length = head.Int<std::uint64_t>();
    if (length > kMaxRecord || length > size_ - tail - at - mcap::kRecordHead ||
        !Read(at + mcap::kRecordHead, length, record))
      return;
    if (opcode == mcap::kSchema) (void)ReadSchema(record);
    if (opcode == mcap::kChannel) (void)ReadChannel(record);
    at += mcap::kRecordHead + length;
  }
}

// Moves from an invalid record to the next sound chunk. False if there is none.
bool McapReader::SkipToNextChunk(const std::string& reason) {
  // Search the file in blocks of 1 MiB. Neighbouring blocks overlap by a chunk's head, so that no head is
  // cut.
  constexpr std::uint64_t kBlock = 1u << 20, kHead = mcap::kRecordHead + kChunkHead;
  std::string block;
  for (std::uint64_t start = offset_ + 1; size_ - start > kHead; start += kBlock) {
    if (!Read(start, std::min(kBlock + kHead, size_ - start), block)) break;
    for (std::size_t i = 0; i < kBlock && i + kHead < block.size(); ++i) {
      if (block[i] != mcap::kChunk) continue;
      Cursor cursor(std::span<const char>(block).subspan(i + 1));
      const auto length = cursor.Int<std::uint64_t>();
      if (length < kChunkHead || length > std::min(kMaxRecord, size_ - start - i - mcap::kRecordHead))
        continue;
      cursor.Int<std::uint64_t>();
      cursor.Int<std::uint64_t>();
      const auto unpacked_size = cursor.Int<std::uint64_t>();
      cursor.Int<std::uint32_t>();
      const auto name_size = cursor.Int<std::uint32_t>();
      // check the head first, before the whole chunk is read
      const bool may_be = name_size == 0 ? unpacked_size == length - kChunkHead
                                         : name_size == 3 || name_size == 4;  // "lz4", "zstd"
      if (!may_be || !IsSoundChunk(start + i, length)) continue;
      damage_.push_back({offset_, start + i - offset_, reason});
      offset_ = start + i;
      return true;
    }
  }
  return false;
}

bool McapReader::IsSoundChunk(std::uint64_t offset, std::uint64_t length) {
  std::string content;
  if (!Read(offset + mcap::kRecordHead, length, content)) return false;
  Cursor cursor(content);
  cursor.Int<std::uint64_t>();
  cursor.Int<std::uint64_t>();
  const auto unpacked_size = cursor.Int<std::uint64_t>();
  const auto crc = cursor.Int<std::uint32_t>();
  const std::string_view compression = cursor.String();
  const auto size = cursor.Int<std::uint64_t>();
  if (!cursor.ok() || size != cursor.rest().size()) return false;
  const auto records = mcap::Decompress(compression, cursor.rest(), unpacked_size);
  return records && crc == Crc(0, *records);
}

bool McapReader::IsZeroToTheEnd() {
  std::string block;
  for (std::uint64_t at = offset_; at < size_; at += block.size())
    if (!Read(at, std::min<std::uint64_t>(1u << 20, size_ - at), block) ||
        block.find_first_not_of('\0') != std::string::npos)
      return false;
  return true;
}

bool McapReader::Read(std::uint64_t offset, std::uint64_t length, std::string& bytes) {
  bytes.resize(length);
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(offset));
  file_.read(bytes.data(), static_cast<std::streamsize>(length));
  return static_cast<bool>(file_);
}

}  // namespace osteon::io
