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

/// The state of a playback.
struct PlaybackState {
  double at_s{0.0};  ///< present time on the time line
  double duration_s{0.0};
  bool playing{false};
  double speed{1.0};
  std::string error;  ///< why the playback ended early, such as a damaged chunk; empty: it did not
};

/// Plays a recording into a feed, in a thread of its own: the pages then show it as they show a cell that
/// runs.
///
///     Seek ──▶ at once only the new time ──▶ then also the kBefore_s before it, unless another Seek came
class Playback {
 public:
  static constexpr double kMinSpeed = 0.1, kMaxSpeed = 20.0;
  /// Time that is loaded before the present time: the half minute of a page's strip charts, and a chunk of
  /// the recording.
  static constexpr double kBefore_s = 30.5;
  /// Number of windows (batches of messages) that the feed must keep so that a page gets all of kBefore_s.
  static constexpr std::uint64_t kFeedWindows = 1000;

  /// @param feed  must outlive this object
  Playback(RecordingTimeline timeline, console::LiveFeed& feed);
  ~Playback();
  Playback(const Playback&) = delete;
  Playback& operator=(const Playback&) = delete;

  /// Continues to play; at the end of the recording, plays from the beginning.
  void Play();
  void Halt();
  /// Jumps to a time, clamped to the recording; a time that is not finite is ignored.
  void Seek(double at_s);
  /// Moves to a time close to the present one while the recording plays, without a break. If at_s is later,
  /// plays up to it at once; if it is earlier, waits until the time has come.
  void Align(double at_s);
  /// Sets the speed, clamped to kMinSpeed … kMaxSpeed; a value that is not finite is ignored.
  void SetSpeed(double speed);
  [[nodiscard]] PlaybackState state() const;

 private:
  // Why passing on messages has ended: the wanted time was reached, the recording ended, or another Seek
  // came.
  enum class Passed : std::uint8_t { kReached, kEnd, kLeft };
  using PassedOrError = tl::expected<Passed, std::string>;

  void Run();
  [[nodiscard]] bool Seeks() const;  // whether the thread has a Seek to do, or is to end
  [[nodiscard]] PassedOrError PassUntil(double at_s, console::LiveFeed& feed, bool leaves);
  [[nodiscard]] PassedOrError Show(double at_s, double before_s, bool leaves);
  [[nodiscard]] PassedOrError JumpTo(double at_s);

  RecordingTimeline timeline_;  // used only by the thread once it runs, like passed_s_
  double passed_s_{0.0};        // time of the last tick that was passed on
  console::LiveFeed& feed_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  PlaybackState state_;
  double seek_s_{0.0};             // time asked for by Seek
  std::optional<double> align_s_;  // time asked for by Align
  bool seeks_{true};               // a Seek is to be done; initially a Seek to the beginning
  bool stop_{false};
  std::thread thread_;
};

}  // namespace osteon::session
