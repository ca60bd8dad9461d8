#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include <tl/expected.hpp>

#include "console/stream/live_feed.h"
#include "session/view/recording_timeline.h"

namespace osteon::session {

/// Where a playback stands.
struct PlaybackState {
  double at_s{0.0};  ///< on the time line
  double duration_s{0.0};
  bool playing{false};
  double speed{1.0};
  std::string error;  ///< why it ended early: a damaged chunk; empty: it did not
};

/// Plays a recording into a feed, in a thread of its own: the pages then show it as they show a cell that
/// runs.
///
///     Seek ──▶ the place alone, at once ──▶ the kBefore_s before it as well, unless another Seek came
class Playback {
 public:
  static constexpr double kMinSpeed = 0.1, kMaxSpeed = 20.0;
  /// Time before a place that is shown with it: the half minute of a page's strip charts, and a chunk.
  static constexpr double kBefore_s = 30.5;
  /// Windows that the feed should keep, so that a page has all of that time.
  static constexpr std::uint64_t kFeedWindows = 1000;

  /// @param feed  outlives this
  Playback(RecordingTimeline timeline, console::LiveFeed& feed);
  ~Playback();
  Playback(const Playback&) = delete;
  Playback& operator=(const Playback&) = delete;

  void Play();
  void Halt();
  void Seek(double at_s);
  /// Corrects the time by a little while it plays, without a break: goes on to a later one, or waits for an
  /// earlier one.
  void Align(double at_s);
  /// Clamped to kMinSpeed … kMaxSpeed; a value that is not finite is ignored.
  void SetSpeed(double speed);
  [[nodiscard]] PlaybackState state() const;

 private:
  enum class Passed : std::uint8_t { kReached, kEnd, kLeft };  // kLeft: another Seek came
  using PassedOrError = tl::expected<Passed, std::string>;

  void Run();
  [[nodiscard]] bool Seeks() const;
  [[nodiscard]] PassedOrError PassUntil(double at_s, console::LiveFeed& feed, bool leaves);
  [[nodiscard]] PassedOrError Show(double at_s, double before_s, bool leaves);
  [[nodiscard]] PassedOrError JumpTo(double at_s);

  RecordingTimeline timeline_;  // of the thread alone, once it runs, as passed_s_
  double passed_s_{0.0};        // time of the last tick that was passed on
  console::LiveFeed& feed_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  PlaybackState state_;
  double seek_s_{0.0};
  std::optional<double> align_s_;
  bool seeks_{true};  // shows the beginning at first
  bool stop_{false};
  std::thread thread_;
};

}  // namespace osteon::session
