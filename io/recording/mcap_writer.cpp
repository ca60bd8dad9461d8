#include "io/recording/mcap_writer.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "io/recording/mcap_bytes.h"

namespace osteon::io {
namespace {

using mcap::AppendInt;
using mcap::AppendRecord;
using mcap::AppendString;
using mcap::Crc;

// "PATH: WHAT: the text of an errno".
std::string Explain(const std::filesystem::path& path, const char* what, int error) {
  return path.string() + ": " + what + ": " + std::generic_category().message(error);
}

// Opens the file, locks it for this process, and empties it. On an error returns null, and errno gives the
// reason. EWOULDBLOCK means that another process has locked the file.
std::FILE* OpenLocked(const std::filesystem::path& path) {
  const int descriptor = open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) return nullptr;
  struct stat status;  // NOLINT: filled by the call
  const bool is_file = fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
  // On a file system without locks, flock fails with another errno. The file is then treated as not locked.
  const bool is_taken = is_file && flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  std::FILE* file = nullptr;
  if (!is_taken && (!is_file || ftruncate(descriptor, 0) == 0)) file = fdopen(descriptor, "wb");
  if (file == nullptr) {
    const int error = is_taken ? EWOULDBLOCK : errno;
    close(descriptor);
    errno = error;
  }
  return file;
}

}  // namespace

tl::expected<McapWriter, std::string> McapWriter::Create(const std::filesystem::path& path,
                                                         std::string_view library,
                                                         const McapWriterParams& params) {
  std::FILE* file = OpenLocked(path);
  if (file == nullptr)
    return tl::unexpected(errno == EWOULDBLOCK
                              ? path.string() + ": another process records into it, accepted another name"
                              : Explain(path, "cannot create the recording", errno));
  McapWriter writer(path, file, params);
  std::string header;
  AppendString(header, "");  // no profile: plain protobuf channels
  AppendString(header, library);
  std::string start(mcap::kMagic);
  AppendRecord(start, mcap::kHeader, header);
  writer.WriteBytes(start);
  return writer;
}

std::uint16_t McapWriter::AddChannel(std::string_view topic, std::string_view message_type,
                                     std::string_view schema_text, std::string_view schema_encoding,
                                     std::string_view message_encoding) {
  const auto id = static_cast<std::uint16_t>(channels_.size());
  const auto schema_id = static_cast<std::uint16_t>(id + 1);  // 0 would mean "no schema"
  std::string schema, channel;
  AppendInt(schema, schema_id);
  AppendString(schema, message_type);
  AppendString(schema, schema_encoding);
  AppendString(schema, schema_text);
  AppendInt(channel, id);
  AppendInt(channel, schema_id);
  AppendString(channel, topic);
  AppendString(channel, message_encoding);
  AppendInt(channel, std::uint32_t{0});  // no metadata

  Channel& added = channels_.emplace_back();
  AppendRecord(added.schema_record, mcap::kSchema, schema);
  AppendRecord(added.channel_record, mcap::kChannel, channel);
  return id;
}

void McapWriter::TimeRange::Add(std::uint64_t time_ns) {
  first_ns = messages == 0 ? time_ns : std::min(first_ns, time_ns);
  last_ns = std::max(last_ns, time_ns);
  ++messages;
}

void McapWriter::Write(std::uint16_t channel_id, std::int64_t stamp_ns, std::string_view bytes) {
  const auto time = static_cast<std::uint64_t>(std::max<std::int64_t>(0, stamp_ns));
  times_.Add(time);
  if (failed()) {
    ++lost_;
    return;
  }
  if (chunk_times_.messages > 0 && time > chunk_times_.first_ns + std::uint64_t{kChunkTime_ns}) EndChunk();
  chunk_times_.Add(time);

  // a channel's first message is preceded by its schema and channel records
  Channel& channel = channels_[channel_id];
  if (channel.messages == 0) {
    chunk_ += channel.schema_record;
    chunk_ += channel.channel_record;
  }
  AppendInt(channel.chunk_index, time);
  AppendInt(channel.chunk_index, std::uint64_t{chunk_.size()});

  constexpr std::size_t kFixed = 2 + 4 + 8 + 8;  // channel, sequence, two times
  chunk_.push_back(static_cast<char>(mcap::kMessage));
  AppendInt(chunk_, std::uint64_t{kFixed + bytes.size()});
  AppendInt(chunk_, channel_id);
  AppendInt(chunk_, channel.messages++);
  AppendInt(chunk_, time);
  AppendInt(chunk_, time);
  chunk_.append(bytes);
  if (chunk_.size() > params_.chunk_bytes) EndChunk();
}

void McapWriter::EndChunk() {
  if (chunk_.empty()) return;
  const std::uint64_t start = size_, messages = chunk_times_.messages;
  const std::string_view compressed = params_.compress ? compressor_.Compress(chunk_) : std::string_view();
  const std::string_view compression = compressed.empty() ? "" : "zstd";
  const std::string_view stored = compressed.empty() ? std::string_view(chunk_) : compressed;
  std::string content, record;
  AppendInt(content, chunk_times_.first_ns);
  AppendInt(content, chunk_times_.last_ns);
  AppendInt(content, std::uint64_t{chunk_.size()});
  AppendInt(content, Crc(0, chunk_));
  AppendString(content, compression);
  AppendInt(content, std::uint64_t{stored.size()});
  content += stored;
  AppendRecord(record, mcap::kChunk, content);
  WriteBytes(record);
  const std::uint64_t length = record.size(), indexes_start = size_;
  std::string index_offsets;
  PutMessageIndexes(index_offsets);

  // the chunk's position in the file, for the summary
  content.clear();
  AppendInt(content, chunk_times_.first_ns);
  AppendInt(content, chunk_times_.last_ns);
  AppendInt(content, start);
  AppendInt(content, length);
  AppendString(content, index_offsets);
  AppendInt(content, size_ - indexes_start);
  AppendString(content, compression);
  AppendInt(content, std::uint64_t{stored.size()});
  AppendInt(content, std::uint64_t{chunk_.size()});
  AppendRecord(chunk_indexes_, mcap::kChunkIndex, content);

  ++chunks_;
  chunk_.clear();
  chunk_times_ = {};
  // all of them count as lost, although a part of the chunk may be in the file
  if (failed()) lost_ += messages;
}

// Writes the positions of each channel's messages in the chunk; `offsets` receives the file position of each
// index.
void McapWriter::PutMessageIndexes(std::string& offsets) {
  std::string content, record;
  for (std::size_t id = 0; id < channels_.size(); ++id) {
    if (channels_[id].chunk_index.empty()) continue;
    AppendInt(offsets, static_cast<std::uint16_t>(id));
    AppendInt(offsets, size_);
    content.clear();
    record.clear();
    AppendInt(content, static_cast<std::uint16_t>(id));
    AppendString(content, channels_[id].chunk_index);
    AppendRecord(record, mcap::kMessageIndex, content);
    WriteBytes(record);
    channels_[id].chunk_index.clear();
  }
}

void McapWriter::WriteBytes(std::string_view bytes) {
  if (failed()) return;
  crc_ = Crc(crc_, bytes);
  size_ += bytes.size();
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) Fail(errno);
}

void McapWriter::Fail(int error) { error_ = Explain(path_, "cannot write the recording", error); }

void McapWriter::Flush() {
  if (!failed() && std::fflush(file_.get()) != 0) Fail(errno);
}

// Returns an error if the path no longer leads to the open file. A file that was removed or replaced accepts
// every byte and disappears when it is closed, so writing alone reports no error.
std::string McapWriter::ValidateStillAtPath() const {
  struct stat now, made;  // NOLINT: filled by the calls
  if (fstat(fileno(file_.get()), &made) != 0) return Explain(path_, "cannot write the recording", errno);
  if (stat(path_.c_str(), &now) != 0 || now.st_ino != made.st_ino || now.st_dev != made.st_dev)
    return path_.string() + ": the recording was removed or replaced while it was written";
  return {};
}

std::string McapWriter::Sync() const {
  std::string wrong = ValidateStillAtPath();
  if (!wrong.empty()) return wrong;
  // a pipe or a device does not support fdatasync (EINVAL, EROFS), and that is no error
  if (fdatasync(fileno(file_.get())) != 0 && errno != EINVAL && errno != EROFS)
    return Explain(path_, "cannot bring the recording to the disk", errno);
  return {};
}

tl::expected<std::uint64_t, std::string> McapWriter::Finish(bool to_disk) {
  EndChunk();
  std::string data_end, tail;
  AppendInt(data_end, crc_);
  AppendRecord(tail, mcap::kDataEnd, data_end);
  WriteBytes(tail);

  // summary: schemas and channels in use, statistics, chunks
  const std::uint64_t summary_start = size_;
  std::string summary, channel_records, statistics, counts;
  std::uint32_t used = 0;
  for (std::size_t id = 0; id < channels_.size(); ++id) {
    if (channels_[id].messages == 0) continue;
    ++used;
    summary += channels_[id].schema_record;
    channel_records += channels_[id].channel_record;
    AppendInt(counts, static_cast<std::uint16_t>(id));
    AppendInt(counts, std::uint64_t{channels_[id].messages});
  }
  summary += channel_records;
  AppendInt(statistics, times_.messages);
  AppendInt(statistics, static_cast<std::uint16_t>(used));  // schemas
  AppendInt(statistics, used);                              // channels
  AppendInt(statistics, std::uint32_t{0});                  // attachments
  AppendInt(statistics, std::uint32_t{0});                  // metadata
  AppendInt(statistics, chunks_);
  AppendInt(statistics, times_.first_ns);
  AppendInt(statistics, times_.last_ns);
  AppendString(statistics, counts);
  AppendRecord(summary, mcap::kStatistics, statistics);
  summary += chunk_indexes_;

  // footer; its CRC covers the summary and the footer's bytes before the CRC
  std::string footer;
  AppendInt(footer, summary_start);
  AppendInt(footer, std::uint64_t{0});  // no summary offsets
  AppendInt(footer, std::uint32_t{0});
  AppendRecord(summary, mcap::kFooter, footer);
  summary.resize(summary.size() - sizeof(std::uint32_t));
  AppendInt(summary, Crc(0, summary));
  summary += mcap::kMagic;
  WriteBytes(summary);

  Flush();
  if (!failed()) error_ = to_disk ? Sync() : ValidateStillAtPath();
  if (std::fclose(file_.release()) != 0 && !failed()) Fail(errno);
  if (failed()) return tl::unexpected(error_);
  return size_;
}

}  // namespace osteon::io
