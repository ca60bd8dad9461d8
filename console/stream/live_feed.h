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

/// The live views' source: gathers what is recorded into windows, and keeps the newest for any number of
/// readers.
///
///     recorder's writer ──TakeTick, TakeFrame, TakeEvent──▶ window in the making ──▶ the last windows ◀── readers
///
/// It never stalls the recorder: the writer only tries the lock. While a reader has it, ticks go on gathering
/// in the window in the making. A reader copies under the lock and does all else without it.
class LiveFeed final : public io::RecordSink {
 public:
  static constexpr std::uint64_t kKept = 128;                ///< windows of a cell that runs: 4 s
  static constexpr rt::Nanoseconds kWindow_ns = 33'000'000;  ///< log time of one window
  static constexpr std::size_t kKeptEvents = 200;            ///< number of events

  /// @param kept  windows for a reader that comes late, at least 1; each has 3 kB
  explicit LiveFeed(std::uint64_t kept = kKept);
  void TakeTick(const control::TickRecord& tick) override;
  void TakeFrame(const simulation::FrameRecord& frame) override;
  void TakeEvent(const io::RecordedEvent& event) override;

  /// Publishes the window in the making at once. For a playback, which has no recorder; waits for readers.
  void Flush();
  /// Replaces everything gathered by what `other` has gathered, for all readers at once: a playback went to
  /// another time. Readers notice the change by epoch().
  /// @pre `other` keeps as many windows, and has no reader. Its content is void afterwards.
  void ShowInstead(LiveFeed& other);
  /// Number of calls of ShowInstead. The numbers of windows and events begin anew in each epoch.
  [[nodiscard]] std::uint64_t epoch() const;
  [[nodiscard]] std::uint64_t kept() const { return kept_; }

  /// The newest window; number 0: none yet. Any thread but the recorder's.
  [[nodiscard]] LiveWindow Newest() const;
  /// The windows after number `seen`, oldest first, at most kept(); `seen` becomes the last one's. A slow
  /// reader does not get older windows.
  [[nodiscard]] std::vector<LiveWindow> Since(std::uint64_t& seen) const;
  /// Events after the first `seen` of the session, at most the last kKeptEvents; `seen` becomes their count.
  [[nodiscard]] std::vector<io::RecordedEvent> EventsSince(std::uint64_t& seen) const;

 private:
  // Adds a tick to the window in the making.
  void Gather(const control::TickRecord& tick);
  // Publishes, unless a reader holds the lock.
  void TryPublish();
  // Hands the window in the making and the waiting events to the readers. @pre mutex_ is held
  void Publish();

  const std::uint64_t kept_;

  // used by the recorder's writer alone
  LiveWindow making_;
  rt::Nanoseconds began_{0};                // stamp of its first tick
  std::uint32_t limits_before_{0};          // of the window before
  rt::DurationHistogram compute_, wakeup_;  // of all ticks so far
  std::vector<io::RecordedEvent> waiting_events_;

  mutable std::mutex mutex_;              // guards what follows
  std::vector<LiveWindow> windows_;       // kept_ of them
  std::atomic<std::uint64_t> newest_{0};  // read without the lock by a reader for whom nothing is new
  std::deque<io::RecordedEvent> events_;
  std::uint64_t events_so_far_{0};
  std::uint64_t epoch_{0};
};

}  // namespace osteon::console
