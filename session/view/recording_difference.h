#pragma once

#include <array>
#include <atomic>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "control/tick_record.h"
#include "session/view/recording_timeline.h"

namespace osteon::session {

/// The differences of two runs at the same time, counted from the start of each session.
struct TickDifference {
  double force_N{0.0};   ///< magnitude of the difference of the rendered forces
  double apart_mm{0.0};  ///< distance between the origins of the commanded tools
  double turn_deg{0.0};  ///< angle between the orientations of the commanded tools
};

/// Computes the differences of two ticks.
[[nodiscard]] TickDifference Compare(const control::TickRecord& first, const control::TickRecord& second);

/// Reads two recordings in the background and compares them tick by tick along their common time.
///
///     first   ──tick──tick──tick──▶   each tick with the other recording's newest tick that is not later
///     second  ──tick──────tick────▶
class RecordingDifference {
 public:
  static constexpr std::size_t kMaxBins = 2000;  ///< bins of the time line: about a page's width in pixels

  explicit RecordingDifference(const std::array<std::filesystem::path, 2>& recordings);
  ~RecordingDifference();
  RecordingDifference(const RecordingDifference&) = delete;
  RecordingDifference& operator=(const RecordingDifference&) = delete;

  // clang-format off
  /// Makes a JSON object of type "difference". A series has a value for each bin, null where the bin has no tick:
  ///
  ///     "step_s"       width of a bin          "ticks"  number compared     "done"  all is read
  ///     "force_N"      [first, second recording]: largest rendered force of each bin
  ///     "depth_mm"     [first, second]: deepest place of the proxy up to each bin
  ///     "removed_mm3"  [first, second]: removed bone up to each bin
  ///     "force_apart_N", "apart_mm", "turn_deg"   largest TickDifference of each bin
  ///     "most"         largest differences of both runs, each [value, at_s]: "force_N", "apart_mm", "turn_deg",
  ///                    and of "depth_mm", "removed_mm3" the second recording's value minus the first's
  // clang-format on
  [[nodiscard]] std::string Json() const;

 private:
  void Run(const std::array<std::filesystem::path, 2>& recordings);

  mutable std::mutex mutex_;
  std::string json_;  // guarded by mutex_
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace osteon::session
