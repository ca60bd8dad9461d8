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

/// The differences of two runs at the same time since their session's start.
struct TickDifference {
  double force_N{0.0};   ///< size of the difference of the rendered forces
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

  /// Makes {"type": "difference", "step_s", "force_N": [[largest of each bin, first], [second recording]],
  /// "depth_mm": [[deepest of the proxy so far], …], "removed_mm3": [[…], …], "force_apart_N", "apart_mm",
  /// "turn_deg": [largest of each bin], "most": {"force_N": [value, at_s], "depth_mm", "removed_mm3": second
  /// minus first, "apart_mm", "turn_deg"}, "ticks": number compared, "done"}; null if a bin has no tick.
  [[nodiscard]] std::string Json() const;

 private:
  void Run(const std::array<std::filesystem::path, 2>& recordings);

  mutable std::mutex mutex_;
  std::string json_;  // guarded by mutex_
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace osteon::session
