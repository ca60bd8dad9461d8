#include "session/view/playback.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "base/realtime_thread.h"

namespace osteon::session {
namespace {

constexpr std::chrono::milliseconds kStep{16};  // time between two steps of the playback
constexpr double kAtOnce_s = 0.3;               // time before the wanted one that a Seek shows first

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
  if (state_.at_s >= state_.duration_s) {  // at the end: play from the beginning
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

void Playback::Align(double at_s) {
  if (!std::isfinite(at_s)) return;
  const std::lock_guard lock(mutex_);
  if (state_.playing) align_s_ = std::clamp(at_s, 0.0, state_.duration_s);
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

bool Playback::Seeks() const {
  const std::lock_guard lock(mutex_);
  return stop_ || seeks_;
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
      const auto align_s = std::exchange(align_s_, std::nullopt);
      at_s = jump ? seek_s_ : align_s.value_or(state_.at_s);
      speed = state_.playing ? state_.speed : 0.0;
    }
    const auto now = Clock::now();
    // at most 0.1 s, so that the playback does not catch up after a stall
    const double elapsed_s = std::min(0.1, std::chrono::duration<double>(now - before).count());
    before = now;
    if (!jump && speed == 0.0) continue;
    if (!jump) at_s += speed * elapsed_s;
    const PassedOrError passed = jump               ? JumpTo(at_s)
                                 : passed_s_ < at_s ? PassUntil(at_s, feed_, false)
                                                    : Passed::kReached;
    const std::lock_guard lock(mutex_);
    if (!passed) state_.error = passed.error();
    if (seeks_) continue;
    state_.at_s = std::min(at_s, state_.duration_s);
    if (!passed || *passed == Passed::kEnd || state_.at_s >= state_.duration_s) state_.playing = false;
  }
}

// Shows first the last kAtOnce_s before the new time, which is quick: dragging the time line requests many
// times in a row. Then shows kBefore_s, the whole time span of the charts.
Playback::PassedOrError Playback::JumpTo(double at_s) {
  PassedOrError place = Show(at_s, kAtOnce_s, false);
  if (!place || at_s <= kAtOnce_s) return place;
  {
    const std::lock_guard lock(mutex_);
    if (!seeks_) state_.at_s = std::min(at_s, state_.duration_s);  // the bone need not wait for the charts
  }
  // if an earlier chunk is damaged, Show fails: then show only the time around at_s, without the charts' past
  if (Show(at_s, kBefore_s, true)) return place;
  return Show(at_s, kAtOnce_s, false);
}

// Replaces the feed's content by the messages from at_s - before_s to at_s.
// @param leaves true: another Seek ends this one early, and the feed then keeps its content
Playback::PassedOrError Playback::Show(double at_s, double before_s, bool leaves) {
  console::LiveFeed new_feed(feed_.kept());
  (void)timeline_.Seek(std::max(0.0, at_s - before_s));
  PassedOrError passed = PassUntil(at_s, new_feed, leaves);
  if (leaves && (!passed || *passed == Passed::kLeft)) return passed;
  new_feed.Flush();
  feed_.ShowInstead(new_feed);
  return passed;
}

// Passes the time line's next messages to a feed, up to a time. @param leaves true: another Seek ends this
// early
Playback::PassedOrError Playback::PassUntil(double at_s, console::LiveFeed& feed, bool leaves) {
  const io::RecordingStream& message = timeline_.message();
  while (true) {
    const auto topic = timeline_.Next();
    if (!topic) return tl::unexpected(topic.error());
    switch (*topic) {
      case io::RecordedTopic::kTick:
        feed.TakeTick(message.tick);
        passed_s_ = timeline_.At(message.tick.stamp);
        if (passed_s_ >= at_s) return Passed::kReached;
        if (leaves && Seeks()) return Passed::kLeft;
        break;
      case io::RecordedTopic::kFrame:
        feed.TakeFrame(message.frame);
        break;
      case io::RecordedTopic::kEvent:
        feed.TakeEvent(message.event);
        break;
      case io::RecordedTopic::kSession:
        break;
      case io::RecordedTopic::kOther:
        return Passed::kEnd;
    }
  }
}

}  // namespace osteon::session
