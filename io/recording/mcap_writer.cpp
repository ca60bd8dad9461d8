#include "io/recording/mcap_writer.h"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <type_traits>
#include <utility>

#include "io/recording/mcap.h"

namespace osteon::io {
namespace {

template <class T>
void AppendInt(std::string& out, T value) {
  static_assert(std::is_unsigned_v<T>);
  for (std::size_t i = 0; i < sizeof(T); ++i) out.push_back(static_cast<char>(value >> (8 * i) & 0xff));
}

void AppendString(std::string& out, std::string_view text) {
  AppendInt(out, static_cast<std::uint32_t>(text.size()));
  out.append(text);
}

void AppendRecord(std::string& out, mcap::Opcode opcode, std::string_view content) {
  out.push_back(static_cast<char>(opcode));
  AppendInt(out, std::uint64_t{content.size()});
  out.append(content);
}

std::uint32_t Crc(std::uint32_t crc, std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(crc, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

std::string Explain(const std::filesystem::path& path, const char* what, int error) {
  return path.string() + ": " + what + ": " + std::generic_category().message(error);
}

}  // namespace

tl::expected<McapWriter, std::string> McapWriter::Create(const std::filesystem::path& path,
                                                         std::string_view library) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return tl::unexpected(Explain(path, "cannot create the recording", errno));
  McapWriter writer(path, file);
  std::string header;
  AppendString(header, "");  // no profile: plain protobuf channels
  AppendString(header, library);
  std::string start(mcap::kMagic);
  AppendRecord(start, mcap::kHeader, header);
  writer.Put(start);
  return writer;
}

std::uint16_t McapWriter::AddChannel(std::string_view topic, std::string_view message_type,
                                     std::string_view descriptor_set) {
  const auto id = static_cast<std::uint16_t>(channels_.size());
  const auto schema_id = static_cast<std::uint16_t>(id + 1);  // 0 would mean "no schema"
  std::string schema, channel;
  AppendInt(schema, schema_id);
  AppendString(schema, message_type);
  AppendString(schema, "protobuf");
  AppendString(schema, descriptor_set);
  AppendInt(channel, id);
  AppendInt(channel, schema_id);
  AppendString(channel, topic);
  AppendString(channel, "protobuf");
  AppendInt(channel, std::uint32_t{0});  // no metadata

  Channel& added = channels_.emplace_back();
  AppendRecord(added.schema_record, mcap::kSchema, schema);
  AppendRecord(added.channel_record, mcap::kChannel, channel);
  Put(added.schema_record);
  Put(added.channel_record);
  return id;
}

void McapWriter::Write(std::uint16_t channel, std::int64_t stamp_ns, std::string_view bytes) {
  const auto time = static_cast<std::uint64_t>(std::max<std::int64_t>(0, stamp_ns));
  first_ns_ = messages_ == 0 ? time : std::min(first_ns_, time);
  last_ns_ = std::max(last_ns_, time);
  ++messages_;

  constexpr std::size_t kFixed = 2 + 4 + 8 + 8;  // channel, sequence, two times
  record_.clear();
  record_.push_back(static_cast<char>(mcap::kMessage));
  AppendInt(record_, std::uint64_t{kFixed + bytes.size()});
  AppendInt(record_, channel);
  AppendInt(record_, channels_[channel].messages++);
  AppendInt(record_, time);
  AppendInt(record_, time);
  record_.append(bytes);
  Put(record_);
}

void McapWriter::Put(std::string_view bytes) {
  if (failed()) return;
  crc_ = Crc(crc_, bytes);
  size_ += bytes.size();
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) Fail();
}

void McapWriter::Fail() { error_ = Explain(path_, "cannot write the recording", errno); }

void McapWriter::Flush() {
  if (!failed() && std::fflush(file_.get()) != 0) Fail();
}

tl::expected<std::uint64_t, std::string> McapWriter::Finish() {
  std::string data_end;
  AppendInt(data_end, crc_);
  std::string tail;
  AppendRecord(tail, mcap::kDataEnd, data_end);
  Put(tail);

  // summary: schemas, channels, statistics
  const std::uint64_t summary_start = size_;
  std::string summary, statistics, counts;
  for (const Channel& channel : channels_) summary += channel.schema_record;
  for (const Channel& channel : channels_) summary += channel.channel_record;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    AppendInt(counts, static_cast<std::uint16_t>(i));
    AppendInt(counts, std::uint64_t{channels_[i].messages});
  }
  AppendInt(statistics, messages_);
  AppendInt(statistics, static_cast<std::uint16_t>(channels_.size()));  // schemas
  AppendInt(statistics, static_cast<std::uint32_t>(channels_.size()));
  for (int i = 0; i < 3; ++i) AppendInt(statistics, std::uint32_t{0});  // attachments, metadata, chunks
  AppendInt(statistics, first_ns_);
  AppendInt(statistics, last_ns_);
  AppendString(statistics, counts);
  AppendRecord(summary, mcap::kStatistics, statistics);

  // footer; its own CRC covers the summary and the footer up to that CRC
  std::string footer;
  AppendInt(footer, summary_start);
  AppendInt(footer, std::uint64_t{0});  // no summary offsets
  AppendInt(footer, std::uint32_t{0});
  AppendRecord(summary, mcap::kFooter, footer);
  summary.resize(summary.size() - sizeof(std::uint32_t));
  AppendInt(summary, Crc(0, summary));
  summary += mcap::kMagic;
  Put(summary);

  Flush();
  if (std::fclose(file_.release()) != 0 && !failed()) Fail();
  if (failed()) return tl::unexpected(error_);
  return size_;
}

}  // namespace osteon::io
