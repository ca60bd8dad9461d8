#pragma once

#include <atomic>
#include <deque>
#include <mutex>
#include <string>
#include <vector>

#include "base/duration_histogram.h"
#include "console/stream/live_window.h"
#include "io/recording/record_sink.h"

namespace osteon::console {

/// The source of the live views: gathers the recorded ticks, frames and events into windows, and keeps the
/// newest windows for any number of readers.
///
///     recorder's writer ──TakeTick, TakeFrame, TakeEvent──▶ window in the making ──▶ the last windows ◀── readers
///
/// It never stalls the recorder, because the writer does not wait for the lock. While a reader holds the
/// lock, the writer adds further ticks to the unfinished window. A reader holds the lock only while it
/// copies.
class LiveFeed final : public io::RecordSink {
 public:
  static constexpr std::uint64_t kKept = 128;                ///< number of windows for a running cell: 4 s
  static constexpr rt::Nanoseconds kWindow_ns = 33'000'000;  ///< log time of one window
  static constexpr std::size_t kKeptEvents = 200;            ///< number of events that are kept

  /// @param kept  number of windows that are kept for slow readers, at least 1; each has 3 kB
  explicit LiveFeed(std::uint64_t kept = kKept);
  void TakeTick(const control::TickRecord& tick) override;
  void TakeFrame(const simulation::FrameRecord& frame) override;
  void TakeEvent(const io::RecordedEvent& event) override;

  /// Publishes the unfinished window at once, and waits for readers that hold the lock. For a playback, which
  /// has no recorder that must not wait.
  void Flush();
  /// Replaces all gathered data by those of `other`, for all readers at the same time. Used when a playback
  /// goes to another time. Readers notice the change by epoch().
  /// @pre `other` keeps the same number of windows and has no reader; it must not be used afterwards
  void ShowInstead(LiveFeed& other);
  /// Number of calls of ShowInstead. The numbers of windows and events begin anew in each epoch.
  [[nodiscard]] std::uint64_t epoch() const;
  [[nodiscard]] std::uint64_t kept() const { return kept_; }

  /// The newest window; number 0: none yet. Any thread but the recorder's.
  [[nodiscard]] LiveWindow Newest() const;
  /// The windows after number `seen`, oldest first, at most kept() of them. Sets `seen` to the number of the
  /// last one. A slow reader misses windows that are no longer kept.
  [[nodiscard]] std::vector<LiveWindow> Since(std::uint64_t& seen) const;
  /// All events except the first `seen` ones of the session, at most the last kKeptEvents. Sets `seen` to the
  /// number of events so far.
  [[nodiscard]] std::vector<io::RecordedEvent> EventsSince(std::uint64_t& seen) const;

 private:
  // Adds a tick to the unfinished window, making_.
  void Gather(const control::TickRecord& tick);
  // Calls Publish, unless a reader holds the lock.
  void TryPublish();
  // Makes the unfinished window and the waiting events available to readers. @pre mutex_ is held
  void Publish();

  const std::uint64_t kept_;

  // the members below are used only by the recorder's writer
  LiveWindow making_;
  rt::Nanoseconds began_{0};                // stamp of the first tick of making_
  std::uint32_t limits_before_{0};          // limits that acted in the previous window
  rt::DurationHistogram compute_, wakeup_;  // durations of all ticks so far
  std::vector<io::RecordedEvent> waiting_events_;

  mutable std::mutex mutex_;         // guards the members below
  std::vector<LiveWindow> windows_;  // the last kept_ windows, as a ring
  // atomic: a reader checks without the lock whether there is a new window
  std::atomic<std::uint64_t> newest_{0};
  std::deque<io::RecordedEvent> events_;
  std::uint64_t events_so_far_{0};
  std::uint64_t epoch_{0};
};

}  // namespace osteon::console
