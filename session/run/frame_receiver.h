#pragma once

#include <atomic>
#include <string>
#include <thread>

#include "io/engine/engine_ports.h"
#include "io/recording/recorder.h"
#include "session/run/frame_runner.h"

namespace osteon::session {

/// Receives the frames of an engine in another process, in wall time. A thread of this process derives
/// events, surface and recording from them. SimulationThread does the same for an engine in this process.
class FrameReceiver {
 public:
  FrameReceiver(FrameRunner& runner, io::EngineClient& client, io::Recorder& recorder);
  ~FrameReceiver();
  FrameReceiver(const FrameReceiver&) = delete;
  FrameReceiver& operator=(const FrameReceiver&) = delete;

  /// Ends the thread after it has taken the frames that have arrived. Safe to call twice.
  void Stop();
  /// After Stop: the exception that ended the thread early; empty if there was none.
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  // Takes frames until Stop, and then those that have already arrived.
  void Loop();

  FrameRunner& runner_;
  io::EngineClient& client_;
  io::Recorder& recorder_;
  std::atomic<bool> stop_{false};
  std::string error_;  // written by the thread, read after it was joined
  std::thread thread_;
};

}  // namespace osteon::session
