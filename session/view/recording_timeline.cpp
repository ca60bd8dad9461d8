#include "session/view/recording_timeline.h"

#include <algorithm>
#include <utility>

namespace osteon::session {

tl::expected<RecordingTimeline, std::string> RecordingTimeline::Open(const std::filesystem::path& path) {
  auto stream = io::RecordingStream::Open(path);
  if (!stream) return tl::unexpected(stream.error());
  // the first message is the session information
  const auto first = stream->Next();
  if (!first) return tl::unexpected(first.error());
  if (*first != io::RecordedTopic::kSession)
    return tl::unexpected(path.string() + ": found another first message, accepted osteon.Session");
  std::vector<io::McapChunkPlace> chunks = stream->FindChunks();
  // remove chunks without messages, which have no times
  std::erase_if(chunks, [](const io::McapChunkPlace& chunk) { return chunk.last_ns < chunk.first_ns; });
  if (chunks.size() < 2) return tl::unexpected(path.string() + ": found no tick, accepted at least 1");
  return RecordingTimeline(std::move(*stream), std::move(chunks));
}

RecordingTimeline::RecordingTimeline(io::RecordingStream stream, std::vector<io::McapChunkPlace> chunks)
    : stream_(std::move(stream)), chunks_(std::move(chunks)) {
  start_ = stream_.session.stamp;
  std::uint64_t last = 0;
  for (const io::McapChunkPlace& chunk : chunks_) last = std::max(last, chunk.last_ns);
  duration_s_ = std::max(0.0, At(static_cast<rt::Nanoseconds>(last)));
}

double RecordingTimeline::Seek(double at_s) {
  const auto wanted = static_cast<std::uint64_t>(start_) +
                      static_cast<std::uint64_t>(1e9 * std::clamp(at_s, 0.0, duration_s_));
  // find the last chunk that begins at or before the time
  auto chunk = std::ranges::upper_bound(chunks_, wanted, {}, &io::McapChunkPlace::first_ns);
  if (chunk != chunks_.begin()) --chunk;
  stream_.SeekTo(chunk->offset);
  return At(static_cast<rt::Nanoseconds>(chunk->first_ns));
}

}  // namespace osteon::session
