#include "io/recording/recovery.h"

#include <optional>
#include <system_error>

#include "io/recording/copied_channels.h"
#include "io/recording/mcap_writer.h"
#include "io/recording/messages.h"
#include "io/recording/recording_reader.h"

namespace osteon::io {
namespace {

// Checks the messages to be kept, and counts them.
class RecoveryCounts {
 public:
  explicit RecoveryCounts(Recovery& recovery) : recovery_(recovery) {}

  /// @returns an empty string, or why the message is invalid.
  std::string CountMessage(const McapMessage& message) {
    switch (TopicOf(*message.channel)) {
      case RecordedTopic::kSession: {
        std::string wrong = Decode(message.bytes, session_);
        has_session_ |= wrong.empty();
        return wrong;
      }
      case RecordedTopic::kTick: {
        control::TickRecord tick;
        if (std::string wrong = Decode(message.bytes, tick); !wrong.empty()) return wrong;
        const double time_s = 1e-9 * static_cast<double>(message.log_time_ns);
        if (next_tick_ && tick.tick > *next_tick_) recovery_.missing_ticks += tick.tick - *next_tick_;
        if (!next_tick_) recovery_.first_s = time_s;
        recovery_.last_s = time_s;
        next_tick_ = tick.tick + 1;
        ++recovery_.ticks;
        return {};
      }
      case RecordedTopic::kFrame: {
        simulation::FrameRecord frame;
        ++recovery_.frames;
        return Decode(message.bytes, frame);
      }
      case RecordedTopic::kEvent: {
        RecordedEvent event;
        ++recovery_.events;
        return Decode(message.bytes, event);
      }
      case RecordedTopic::kOther:
        break;
    }
    return {};
  }
  [[nodiscard]] bool has_session() const { return has_session_; }

 private:
  Recovery& recovery_;
  SessionInfo session_;
  std::optional<std::uint64_t> next_tick_;
  bool has_session_{false};
};

// Returns why a strict reader refuses a file in which nothing was skipped; empty if it reads the whole file.
// Such a file exists: a reader that skips damage also takes schemas and channels from the summary, so it
// accepts a message whose channel is declared only there. A strict reader refuses that message.
std::string ValidateReadable(const std::filesystem::path& path) {
  auto stream = RecordingStream::Open(path);
  if (!stream) return stream.error();
  for (;;) {
    const auto topic = stream->Next();
    if (!topic) return topic.error();
    if (*topic == RecordedTopic::kOther) break;
  }
  const std::string wrong = stream->EndError();
  return wrong.empty() ? wrong : path.string() + ": " + wrong;
}

}  // namespace

tl::expected<Recovery, std::string> RecoverRecording(const std::filesystem::path& from,
                                                     const std::filesystem::path& to) {
  Recovery recovery;
  auto reader = McapReader::Open(from, McapReader::OnDamage::kSkip);
  if (!reader) return tl::unexpected(reader.error());
  std::error_code ignored;
  if (std::filesystem::equivalent(from, to, ignored))
    return tl::unexpected(to.string() + ": found the torn recording itself, accepted another file");

  // Write to a temporary file beside `to`, which replaces `to` at the end.
  const std::filesystem::path part = to.string() + ".part";
  auto writer = McapWriter::Create(part, reader->library());
  if (!writer) return tl::unexpected(writer.error());
  const auto discard = [&](std::string error) -> tl::unexpected<std::string> {
    std::filesystem::remove(part, ignored);
    return tl::unexpected(std::move(error));
  };
  RecoveryCounts counts(recovery);
  CopiedChannels channels(*writer);
  McapMessage message;
  for (;;) {
    const auto more = reader->Next(message);
    if (!more) return discard(more.error());
    if (!*more) break;
    const Recovery before = recovery;  // restored if the message is invalid
    if (const std::string wrong = counts.CountMessage(message); !wrong.empty()) {
      recovery = before;
      if (!message.checked) break;  // the file is truncated here
      recovery.damage.push_back({reader->message_offset(), message.bytes.size(), wrong});
      continue;
    }
    const auto channel = channels.IdOf(*message.channel);
    if (!channel) return discard(from.string() + ": " + channel.error());
    writer->Write(*channel, static_cast<std::int64_t>(message.log_time_ns),
                  {message.bytes.data(), message.bytes.size()});
    ++recovery.messages;
    if (!message.checked) ++recovery.unchecked;
  }
  if (!counts.has_session())
    return discard(from.string() + ": no osteon.Session left in it: nothing to recover");
  recovery.damage.insert(recovery.damage.end(), reader->damage().begin(), reader->damage().end());
  recovery.closed = reader->closed();
  recovery.was_whole = reader->complete() && recovery.damage.empty();
  if (recovery.was_whole)
    if (std::string wrong = ValidateReadable(from); !wrong.empty()) {
      recovery.damage.push_back({.offset = 0, .bytes = 0, .reason = std::move(wrong)});
      recovery.was_whole = false;
    }
  if (recovery.was_whole) {
    std::filesystem::remove(part, ignored);
    return recovery;
  }
  // Damage that reaches the file's end is already listed in recovery.damage, so its bytes are not counted as
  // a tail as well.
  const auto& damage = reader->damage();
  const bool to_the_end =
      !damage.empty() && damage.back().offset + damage.back().bytes >= reader->file_bytes();
  recovery.tail_bytes = to_the_end ? 0 : reader->file_bytes() - reader->read_bytes();

  const auto bytes = writer->Finish();
  if (!bytes) return discard(bytes.error());
  recovery.bytes = *bytes;
  std::error_code error;
  std::filesystem::rename(part, to, error);
  if (error) return discard(to.string() + ": cannot write: " + error.message());
  return recovery;
}

}  // namespace osteon::io
