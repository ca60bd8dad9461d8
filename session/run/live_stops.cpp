#include "session/run/live_stops.h"

#include <utility>

#include "base/realtime_thread.h"

namespace osteon::session {

LiveStops::LiveStops(LiveStopsParams params, io::RecordSink& next)
    : params_(std::move(params)), next_(next), thread_([this] { Run(); }) {}

LiveStops::~LiveStops() { Finish(); }

void LiveStops::TakeTick(const control::TickRecord& tick) {
  next_.TakeTick(tick);
  auto stop = finder_.Add(tick);
  if (!stop || stop->IsOrderly()) return;  // the page of an orderly end is written only after the run
  {
    const std::lock_guard lock(mutex_);
    stops_.push_back({.record = std::move(*stop), .number = ++count_});
  }
  wake_.notify_all();
}

void LiveStops::Finish() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void LiveStops::Run() {
  rt::NameThread("stop pages");
  rt::LowerPriority();
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [this] { return ended_ || !stops_.empty(); });
    if (stops_.empty()) return;
    const Stop stop = std::move(stops_.front());
    stops_.pop_front();
    lock.unlock();
    const StopFiles files{.folder = params_.folder,
                          .stem = params_.recording.stem().string(),
                          .cell = params_.cell,
                          .recording = params_.recording,
                          .session_stamp = stop.record.first_stamp,
                          .force_limit_N = params_.force_limit_N,
                          .end_reason = {},
                          .console_url = params_.console_url};
    (void)WriteStop(stop.record, stop.number, files);
    lock.lock();
  }
}

}  // namespace osteon::session
