#include "io/recording/recorder.h"

#include <chrono>
#include <limits>
#include <utility>

namespace osteon::io {
namespace {

constexpr auto kDrainPeriod = std::chrono::milliseconds(20);
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
  file.EndChunk();
  file.Flush();
  if (file.failed()) return tl::unexpected(recorder->Close().error());  // a full disk shows at once

  if (params.writer_thread) recorder->thread_ = std::thread([r = recorder.get()] { r->RunWriter(); });
  return recorder;
}

Recorder::Recorder(const RecorderParams& params, McapWriter writer)
    : ticks_(params.tick_capacity), frames_(params.frame_capacity), writer_(std::move(writer)) {}

Recorder::~Recorder() { (void)Close(); }

bool Recorder::Push(const control::TickRecord& record) OSTEON_RT { return ticks_.Push(record); }

bool Recorder::PushFrame(const simulation::FrameRecord& record) OSTEON_RT { return frames_.Push(record); }

void Recorder::PushEvent(rt::Nanoseconds stamp, std::string text) {
  const std::lock_guard lock(events_mutex_);
  events_.push_back({.stamp = stamp, .text = std::move(text)});
}

void Recorder::RunWriter() {
  std::unique_lock lock(stop_mutex_);
  while (!stop_changed_.wait_for(lock, kDrainPeriod, [this] { return stop_; })) {
    lock.unlock();
    Drain();
    lock.lock();
  }
}

void Recorder::Drain() {
  const std::lock_guard lock(writer_mutex_);
  if (closed_) return;
  std::vector<RecordedEvent> events;
  {
    const std::lock_guard events_lock(events_mutex_);
    events.swap(events_);
  }

  // Three queues, each in its own order, merged by stamp.
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
      has_tick = ticks_.Pop(tick);
    } else if (has_frame && frame_stamp <= event_stamp) {
      Encode(frame, bytes_);
      writer_.Write(frame_channel_, frame.stamp, bytes_);
      ++counts_.frames;
      has_frame = frames_.Pop(frame);
    } else {
      Encode(*event, bytes_);
      writer_.Write(event_channel_, event->stamp, bytes_);
      ++counts_.events;
      ++event;
    }
  }
  if (!events.empty()) writer_.EndChunk();  // an event and what led to it must survive a crash
  writer_.Flush();
}

tl::expected<RecordingCounts, std::string> Recorder::Close() {
  {
    const std::lock_guard lock(stop_mutex_);
    stop_ = true;
  }
  stop_changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  Drain();

  const std::lock_guard lock(writer_mutex_);
  if (!closed_) {
    closed_ = true;
    counts_.dropped_ticks = ticks_.dropped();
    counts_.dropped_frames = frames_.dropped();
    if (auto bytes = writer_.Finish())
      counts_.bytes = *bytes;
    else
      close_error_ = bytes.error();
  }
  if (!close_error_.empty()) return tl::unexpected(close_error_);
  return counts_;
}

}  // namespace osteon::io
