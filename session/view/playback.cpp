#include "session/view/playback.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "base/realtime_thread.h"

namespace osteon::session {
namespace {

constexpr std::chrono::milliseconds kStep{16};  // between pieces of the recording
constexpr double kShownBefore_s = 0.3;          // of the ticks before a time, when a page goes there

}  // namespace

Playback::Playback(RecordingTimeline timeline, console::LiveFeed& feed)
    : timeline_(std::move(timeline)), feed_(feed) {
  state_.duration_s = timeline_.duration_s();
  thread_ = std::thread([this] { Run(); });
}

Playback::~Playback() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Playback::Play() {
  const std::lock_guard lock(mutex_);
  if (state_.at_s >= state_.duration_s) {  // from the beginning
    seek_s_ = 0.0;
    seeks_ = true;
  }
  state_.playing = true;
  changed_.notify_all();
}

void Playback::Halt() {
  const std::lock_guard lock(mutex_);
  state_.playing = false;
}

void Playback::Seek(double at_s) {
  if (!std::isfinite(at_s)) return;
  const std::lock_guard lock(mutex_);
  seek_s_ = std::clamp(at_s, 0.0, state_.duration_s);
  seeks_ = true;
  changed_.notify_all();
}

void Playback::SetSpeed(double speed) {
  if (!std::isfinite(speed)) return;
  const std::lock_guard lock(mutex_);
  state_.speed = std::clamp(speed, kMinSpeed, kMaxSpeed);
}

PlaybackState Playback::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

void Playback::Run() {
  rt::NameThread("playback");
  using Clock = std::chrono::steady_clock;
  auto before = Clock::now();
  while (true) {
    double at_s = 0.0, speed = 0.0;
    bool jump = false;
    {
      std::unique_lock lock(mutex_);
      changed_.wait_for(lock, kStep, [this] { return stop_ || seeks_; });
      if (stop_) return;
      jump = std::exchange(seeks_, false);
      at_s = jump ? seek_s_ : state_.at_s;
      speed = state_.playing ? state_.speed : 0.0;
    }
    const auto now = Clock::now();
    // a stall is not made up
    const double passed_s = std::min(0.1, std::chrono::duration<double>(now - before).count());
    before = now;
    if (jump)
      JumpTo(at_s);
    else if (speed > 0.0)
      at_s += speed * passed_s;
    else
      continue;
    const bool more = PassUntil(at_s);
    if (jump) feed_.Flush();
    const std::lock_guard lock(mutex_);
    if (seeks_) continue;
    state_.at_s = std::min(at_s, state_.duration_s);
    if (!more || state_.at_s >= state_.duration_s) state_.playing = false;
  }
}

void Playback::JumpTo(double at_s) {
  (void)timeline_.Seek(std::max(0.0, at_s - kShownBefore_s));
  feed_.Restart();
}

// Passes everything up to a time to the feed. False at the end.
bool Playback::PassUntil(double at_s) {
  const io::RecordingStream& message = timeline_.message();
  io::RecordedTopic topic = io::RecordedTopic::kOther;
  while (true) {
    const auto next = timeline_.Next();
    if (!next) {
      const std::lock_guard lock(mutex_);
      state_.error = next.error();
      return false;
    }
    topic = *next;
    switch (topic) {
      case io::RecordedTopic::kTick:
        feed_.TakeTick(message.tick);
        if (timeline_.At(message.tick.stamp) >= at_s) return true;
        break;
      case io::RecordedTopic::kFrame:
        feed_.TakeFrame(message.frame);
        break;
      case io::RecordedTopic::kEvent:
        feed_.TakeEvent(message.event);
        break;
      case io::RecordedTopic::kSession:
        break;
      case io::RecordedTopic::kOther:
        return false;
    }
  }
}

}  // namespace osteon::session
