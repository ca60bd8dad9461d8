#pragma once

#include <atomic>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>

#include "session/view/recording_timeline.h"

namespace osteon::session {

/// Reads a whole recording in the background for its time line: every event, and each second's largest force.
class RecordingScan {
 public:
  explicit RecordingScan(const std::filesystem::path& path);
  ~RecordingScan();
  RecordingScan(const RecordingScan&) = delete;
  RecordingScan& operator=(const RecordingScan&) = delete;

  /// Makes {"type": "timeline", "events": [[at_s, text], …], "force_N": [largest of each second], "done": …}
  /// from the messages read so far.
  [[nodiscard]] std::string Json() const;

 private:
  void Run(const std::filesystem::path& path);

  mutable std::mutex mutex_;
  std::string json_;  // guarded by mutex_
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace osteon::session
