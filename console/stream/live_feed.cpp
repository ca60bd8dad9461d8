#include "console/stream/live_feed.h"

#include <algorithm>
#include <bit>

#include "safety/cell_state.h"
#include "safety/watchdog.h"

namespace osteon::console {
namespace {

constexpr double kPercentile = 0.99;  // quantile in LiveWindow::compute_p99_us and wakeup_p99_us

double ToMicroseconds(rt::Nanoseconds time) { return 1e-3 * static_cast<double>(time); }

}  // namespace

LiveFeed::LiveFeed(std::uint64_t kept) : kept_(kept), windows_(kept) { waiting_events_.reserve(kKeptEvents); }

void LiveFeed::Gather(const control::TickRecord& tick) {
  LiveWindow& w = making_;
  const double force_N = Length(tick.F_coupling_T_W.f), hand_N = Length(tick.F_operator_T_W.f);
  const double speed = Length(tick.v_WT_cmd_m_per_s);
  const double compute_us = ToMicroseconds(tick.compute_ns), wakeup_us = ToMicroseconds(tick.wakeup_ns);
  const double arm_age_s = safety::StampAge(tick.input.now, tick.input.arm_stamp);
  const double interlock_age_s = safety::StampAge(tick.input.now, tick.input.interlock_stamp);
  if (w.ticks == 0) {  // the window's first tick
    began_ = tick.stamp;
    limits_before_ = w.limits;
    w.limits = 0;
    w.force_N.Begin(force_N);
    w.hand_N.Begin(hand_N);
    w.speed_m_per_s.Begin(speed);
    w.compute_us.Begin(compute_us);
    w.wakeup_us.Begin(wakeup_us);
    w.arm_age_s.Begin(arm_age_s);
    w.interlock_age_s.Begin(interlock_age_s);
  }
  w.force_N.Add(force_N);
  w.hand_N.Add(hand_N);
  w.speed_m_per_s.Add(speed);
  w.compute_us.Add(compute_us);
  w.wakeup_us.Add(wakeup_us);
  w.arm_age_s.Add(arm_age_s);
  w.interlock_age_s.Add(interlock_age_s);
  compute_.Add(tick.compute_ns);
  wakeup_.Add(tick.wakeup_ns);
  // Store the time of each limit that acts now and has acted neither earlier in this window nor in the
  // previous window.
  for (std::uint32_t begun = tick.limits & ~(w.limits | limits_before_); begun != 0; begun &= begun - 1)
    if (const auto limit = static_cast<std::size_t>(std::countr_zero(begun)); limit < safety::kLimitCount)
      w.limit_since[limit] = tick.stamp;
  w.limits |= tick.limits;
  ++w.ticks;
  const auto state = static_cast<safety::CellState>(tick.cell_state);
  if (safety::Renders(state)) w.rendered_s += tick.input.period_s;
  if (state == safety::CellState::kPaused) w.paused_s += tick.input.period_s;
  w.tick = tick;
}

void LiveFeed::TakeTick(const control::TickRecord& tick) {
  Gather(tick);
  if (tick.stamp - began_ >= kWindow_ns) TryPublish();
}

void LiveFeed::TakeFrame(const simulation::FrameRecord& frame) { making_.frame = frame; }

void LiveFeed::TakeEvent(const io::RecordedEvent& event) {
  if (waiting_events_.size() < kKeptEvents) waiting_events_.push_back(event);
  TryPublish();
}

void LiveFeed::TryPublish() {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  // otherwise a reader is copying: the window is published in a later tick and contains more
  if (lock) Publish();
}  // ticks

void LiveFeed::Flush() {
  const std::lock_guard lock(mutex_);
  Publish();
}

void LiveFeed::ShowInstead(LiveFeed& other) {
  making_ = other.making_;
  began_ = other.began_;
  limits_before_ = other.limits_before_;
  compute_ = other.compute_;
  wakeup_ = other.wakeup_;
  waiting_events_.swap(other.waiting_events_);
  const std::lock_guard lock(mutex_);
  windows_.swap(other.windows_);
  newest_ = other.newest_.load();
  events_.swap(other.events_);
  events_so_far_ = other.events_so_far_;
  ++epoch_;
}

std::uint64_t LiveFeed::epoch() const {
  const std::lock_guard lock(mutex_);
  return epoch_;
}

void LiveFeed::Publish() {
  for (io::RecordedEvent& event : waiting_events_) {
    events_.push_back(std::move(event));
    ++events_so_far_;
    if (events_.size() > kKeptEvents) events_.pop_front();
  }
  waiting_events_.clear();
  if (making_.ticks == 0) return;
  making_.compute_p99_us = ToMicroseconds(compute_.Quantile(kPercentile));
  making_.wakeup_p99_us = ToMicroseconds(wakeup_.Quantile(kPercentile));
  making_.number = ++newest_;
  windows_[newest_ % kept_] = making_;
  making_.ticks = 0;
}

LiveWindow LiveFeed::Newest() const {
  const std::lock_guard lock(mutex_);
  return newest_ == 0 ? LiveWindow{} : windows_[newest_ % kept_];
}

std::vector<LiveWindow> LiveFeed::Since(std::uint64_t& seen) const {
  // number of the first window to return, given the number of the newest window
  const auto first_of = [&](std::uint64_t newest) {
    return std::max(seen + 1, newest >= kept_ ? newest - kept_ + 1 : 1);
  };
  std::vector<LiveWindow> windows;
  const std::uint64_t newest = newest_;
  // Nothing is new. After ShowInstead, `seen` may exceed the number of the newest window.
  if (first_of(newest) > newest) {
    seen = std::min(seen, newest);
    return windows;
  }
  // Memory is allocated before the lock is taken, and only for new windows: a window has 3 kB, and each page
  // asks 30 times a second.
  windows.reserve(newest + 1 - first_of(newest));
  const std::lock_guard lock(mutex_);
  std::uint64_t number = first_of(newest_);
  for (; number <= newest_ && windows.size() < windows.capacity(); ++number)
    windows.push_back(windows_[number % kept_]);
  seen = std::min<std::uint64_t>(number - 1, newest_);
  return windows;
}

std::vector<io::RecordedEvent> LiveFeed::EventsSince(std::uint64_t& seen) const {
  const std::lock_guard lock(mutex_);
  // number of events that are no longer kept
  const std::uint64_t gone = events_so_far_ - events_.size();
  // After ShowInstead, `seen` may exceed the number of events.
  const auto first =
      static_cast<std::ptrdiff_t>(std::min(std::max(seen, gone) - gone, std::uint64_t{events_.size()}));
  std::vector<io::RecordedEvent> events(events_.begin() + first, events_.end());
  seen = events_so_far_;
  return events;
}

}  // namespace osteon::console
