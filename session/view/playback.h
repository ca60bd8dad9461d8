#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

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
class Playback {
 public:
  static constexpr double kMinSpeed = 0.1, kMaxSpeed = 20.0;

  /// @param feed  outlives this
  Playback(RecordingTimeline timeline, console::LiveFeed& feed);
  ~Playback();
  Playback(const Playback&) = delete;
  Playback& operator=(const Playback&) = delete;

  void Play();
  void Halt();
  void Seek(double at_s);
  /// Clamped to kMinSpeed … kMaxSpeed; a value that is not finite is ignored.
  void SetSpeed(double speed);
  [[nodiscard]] PlaybackState state() const;

 private:
  void Run();
  bool PassUntil(double at_s);
  void JumpTo(double at_s);

  RecordingTimeline timeline_;  // of the thread alone, once it runs
  console::LiveFeed& feed_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  PlaybackState state_;
  double seek_s_{0.0};
  bool seeks_{true};  // shows the beginning at first
  bool stop_{false};
  std::thread thread_;
};

}  // namespace osteon::session
