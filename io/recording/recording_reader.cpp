#include "io/recording/recording_reader.h"

namespace osteon::io {

RecordedTopic TopicOf(const McapChannel& channel) {
  if (channel.schema_encoding != "protobuf") return RecordedTopic::kOther;
  if (channel.schema_name == "osteon.Session") return RecordedTopic::kSession;
  if (channel.schema_name == "osteon.Tick") return RecordedTopic::kTick;
  if (channel.schema_name == "osteon.Frame") return RecordedTopic::kFrame;
  if (channel.schema_name == "osteon.Event") return RecordedTopic::kEvent;
  return RecordedTopic::kOther;
}

tl::expected<RecordingStream, std::string> RecordingStream::Open(const std::filesystem::path& path) {
  auto reader = McapReader::Open(path);
  if (!reader) return tl::unexpected(reader.error());
  return RecordingStream(std::move(*reader));
}

tl::expected<RecordedTopic, std::string> RecordingStream::Next() {
  McapMessage message;
  while (!cut_off_) {
    const auto more = reader_.Next(message);
    if (!more) return tl::unexpected(more.error());
    if (!*more) break;
    const RecordedTopic topic = TopicOf(*message.channel);
    std::string wrong;
    switch (topic) {
      case RecordedTopic::kSession:
        has_session_ = true;
        wrong = Decode(message.bytes, session);
        break;
      case RecordedTopic::kTick:
        wrong = Decode(message.bytes, tick);
        break;
      case RecordedTopic::kFrame:
        wrong = Decode(message.bytes, frame);
        break;
      case RecordedTopic::kEvent:
        wrong = Decode(message.bytes, event);
        break;
      case RecordedTopic::kOther:
        continue;
    }
    if (wrong.empty()) return topic;
    if (message.checked) return tl::unexpected(reader_.ErrorAt(wrong));
    cut_off_ = true;  // the message is in a chunk that was being written when the process died
  }
  if (!has_session_)
    return tl::unexpected(reader_.path().string() + ": byte " + std::to_string(reader_.read_bytes()) +
                          ": no osteon.Session in it: not a recording of this program");
  return RecordedTopic::kOther;
}

std::string RecordingStream::EndError() const {
  if (complete()) return {};
  const std::string byte = std::to_string(reader_.read_bytes());
  if (!reader_.closed()) return "it ends early, at byte " + byte + ": the process died";
  return "it ends at byte " + byte + ", and " + std::to_string(reader_.file_bytes() - reader_.read_bytes()) +
         " bytes follow, which are not read: another file was appended, or a longer one was here";
}

tl::expected<Recording, std::string> ReadRecording(const std::filesystem::path& path) {
  auto stream = RecordingStream::Open(path);
  if (!stream) return tl::unexpected(stream.error());
  Recording recording;
  for (;;) {
    const auto topic = stream->Next();
    if (!topic) return tl::unexpected(topic.error());
    if (*topic == RecordedTopic::kOther) break;
    if (*topic == RecordedTopic::kTick) recording.ticks.push_back(stream->tick);
    if (*topic == RecordedTopic::kFrame) recording.frames.push_back(stream->frame);
    if (*topic == RecordedTopic::kEvent) recording.events.push_back(std::move(stream->event));
  }
  recording.session = std::move(stream->session);
  recording.complete = stream->complete();
  recording.read_bytes = stream->file().read_bytes();
  recording.end_error = stream->EndError();
  return recording;
}

}  // namespace osteon::io
