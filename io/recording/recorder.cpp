#include "io/recording/recorder.h"

#include <chrono>
#include <limits>
#include <utility>

#include "base/realtime_thread.h"

namespace osteon::io {
namespace {

// Periods of the writer thread (kDrainPeriod: draining the queues; kChunkPeriod: ending a chunk) and of the
// thread that brings the file to the disk (kSyncPeriod).
constexpr auto kDrainPeriod = std::chrono::milliseconds(20);
constexpr auto kChunkPeriod = std::chrono::nanoseconds(McapWriter::kChunkTime_ns);
constexpr auto kSyncPeriod = std::chrono::seconds(1);
// Stamp of an empty queue: later than any message.
constexpr rt::Nanoseconds kNever = std::numeric_limits<rt::Nanoseconds>::max();

}  // namespace

tl::expected<std::unique_ptr<Recorder>, std::string> Recorder::Open(const RecorderParams& params,
                                                                    const SessionInfo& session) {
  auto writer = McapWriter::Create(params.path, "osteon " + session.version);
  if (!writer) return tl::unexpected(writer.error());
  std::unique_ptr<Recorder> recorder(new Recorder(params, std::move(*writer)));

  const std::string schema = RecordingDescriptorSet();
  McapWriter& file = recorder->writer_;
  const std::uint16_t session_channel = file.AddChannel("session", "osteon.Session", schema);
  recorder->tick_channel_ = file.AddChannel("tick", "osteon.Tick", schema);
  recorder->frame_channel_ = file.AddChannel("frame", "osteon.Frame", schema);
  recorder->event_channel_ = file.AddChannel("event", "osteon.Event", schema);
  Encode(session, recorder->bytes_);
  file.Write(session_channel, session.stamp, recorder->bytes_);
  if (params.topics) params.topics->Begin(file, session.stamp);
  file.EndChunk();
  file.Flush();
  if (file.failed()) return tl::unexpected(file.error());  // reports a full disk at once

  if (params.writer_thread) {
    recorder->to_disk_ = true;
    recorder->writer_thread_ = std::thread([r = recorder.get()] { r->RunWriter(); });
    recorder->sync_thread_ = std::thread([r = recorder.get()] { r->RunSync(); });
  }
  return recorder;
}

Recorder::Recorder(const RecorderParams& params, McapWriter writer)
    : stalled_ticks_(params.stalled_ticks),
      live_(params.live),
      topics_(params.topics),
      ticks_(params.tick_capacity),
      frames_(params.frame_capacity),
      writer_(std::move(writer)) {}

Recorder::~Recorder() { (void)Close(); }

bool Recorder::Push(const control::TickRecord& record) OSTEON_RT { return ticks_.Push(record); }

bool Recorder::PushFrame(const simulation::FrameRecord& record) OSTEON_RT { return frames_.Push(record); }

void Recorder::PushEvent(rt::Nanoseconds stamp, std::string text) {
  PushEvent({.stamp = stamp, .text = std::move(text)});
}

void Recorder::PushEvent(RecordedEvent event) {
  const std::lock_guard lock(events_mutex_);
  events_.push_back(std::move(event));
}

bool Recorder::WaitForStop(std::chrono::milliseconds time) {
  std::unique_lock lock(stop_mutex_);
  return stop_changed_.wait_for(lock, time, [this] { return stop_; });
}

// McapWriter ends a chunk by the log times of its messages. If no more messages arrive, this thread ends the
// chunk by its own clock.
void Recorder::RunWriter() {
  rt::NameThread("recorder");
  auto chunk_ended = std::chrono::steady_clock::now();
  while (!WaitForStop(kDrainPeriod)) {
    const auto now = std::chrono::steady_clock::now();
    const bool end_chunk = now - chunk_ended >= kChunkPeriod;
    if (end_chunk) chunk_ended = now;
    Write(end_chunk);
  }
}

void Recorder::RunSync() {
  while (!WaitForStop(kSyncPeriod)) {
    const std::string error = writer_.Sync();
    if (error.empty()) continue;
    const std::lock_guard lock(sync_mutex_);
    sync_error_ = error;
    return;
  }
}

std::string Recorder::error() const {
  {
    const std::lock_guard lock(writer_mutex_);
    if (writer_.failed()) return writer_.error();
  }
  const std::lock_guard lock(sync_mutex_);
  return sync_error_;
}

RecordingCounts Recorder::counts() const {
  const std::lock_guard lock(writer_mutex_);
  RecordingCounts counts = counts_;
  counts.dropped_ticks = ticks_.dropped();
  counts.dropped_frames = frames_.dropped();
  counts.unwritten = writer_.lost_messages();
  return counts;
}

void Recorder::Drain() { Write(false); }

void Recorder::Write(bool end_chunk) {
  const std::lock_guard lock(writer_mutex_);
  if (closed_) return;
  std::vector<RecordedEvent> events;
  {
    const std::lock_guard events_lock(events_mutex_);
    events.swap(events_);
  }

  // Merge the three queues by stamp; each queue keeps its own order.
  control::TickRecord tick;
  simulation::FrameRecord frame;
  bool has_tick = ticks_.Pop(tick), has_frame = frames_.Pop(frame);
  auto event = events.cbegin();
  while (has_tick || has_frame || event != events.cend()) {
    const rt::Nanoseconds tick_stamp = has_tick ? tick.stamp : kNever;
    const rt::Nanoseconds frame_stamp = has_frame ? frame.stamp : kNever;
    const rt::Nanoseconds event_stamp = event != events.cend() ? event->stamp : kNever;
    if (has_tick && tick_stamp <= frame_stamp && tick_stamp <= event_stamp) {
      Encode(tick, bytes_);
      writer_.Write(tick_channel_, tick.stamp, bytes_);
      ++counts_.ticks;
      if (live_) live_->TakeTick(tick);
      if (topics_) topics_->TakeTick(tick, writer_);
      has_tick = ticks_.Pop(tick);
    } else if (has_frame && frame_stamp <= event_stamp) {
      Encode(frame, bytes_);
      writer_.Write(frame_channel_, frame.stamp, bytes_);
      ++counts_.frames;
      if (live_) live_->TakeFrame(frame);
      if (topics_) topics_->TakeFrame(frame, writer_);
      has_frame = frames_.Pop(frame);
    } else {
      Encode(*event, bytes_);
      writer_.Write(event_channel_, event->stamp, bytes_);
      ++counts_.events;
      if (live_) live_->TakeEvent(*event);
      if (topics_) topics_->TakeEvent(*event, writer_);
      ++event;
    }
  }
  // an event and the ticks before it must survive a crash: pass them to the system at once
  if (end_chunk || !events.empty()) writer_.EndChunk();
  writer_.Flush();
}

tl::expected<RecordingCounts, std::string> Recorder::Close() {
  {
    const std::lock_guard lock(stop_mutex_);
    stop_ = true;
  }
  stop_changed_.notify_all();
  for (std::thread* thread : {&writer_thread_, &sync_thread_})
    if (thread->joinable()) thread->join();
  Drain();

  const std::lock_guard lock(writer_mutex_);
  if (!closed_) {
    closed_ = true;
    {
      const std::lock_guard sync_lock(sync_mutex_);
      close_error_ = sync_error_;
    }
    if (topics_) topics_->End(writer_);
    if (const auto bytes = writer_.Finish(to_disk_))
      counts_.bytes = *bytes;
    else
      close_error_ = bytes.error();
    counts_.dropped_ticks = ticks_.dropped();
    counts_.dropped_frames = frames_.dropped();
    counts_.unwritten = writer_.lost_messages();
    if (counts_.unwritten > 0)
      close_error_ += "; " + std::to_string(counts_.unwritten) + " of " + std::to_string(writer_.messages()) +
                      " messages are lost";
  }
  if (!close_error_.empty()) return tl::unexpected(close_error_);
  return counts_;
}

}  // namespace osteon::io
