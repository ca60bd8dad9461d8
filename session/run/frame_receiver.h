#pragma once

#include <atomic>
#include <string>
#include <thread>

#include "io/engine/engine_ports.h"
#include "io/recording/recorder.h"
#include "session/run/frame_runner.h"

namespace osteon::session {

/// Takes the frames of an engine in another process, in wall time. A thread of this process makes events,
/// surface and recording from them, as SimulationThread does with frames of this process.
class FrameReceiver {
 public:
  FrameReceiver(FrameRunner& runner, io::EngineClient& client, io::Recorder& recorder);
  ~FrameReceiver();
  FrameReceiver(const FrameReceiver&) = delete;
  FrameReceiver& operator=(const FrameReceiver&) = delete;

  /// Ends the thread after the frames that have come. Safe to call twice.
  void Stop();
  /// After Stop: the exception that ended the thread early; empty if there was none.
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  // Takes frames until Stop; then those that have already come.
  void Loop();

  FrameRunner& runner_;
  io::EngineClient& client_;
  io::Recorder& recorder_;
  std::atomic<bool> stop_{false};
  std::string error_;  // written by the thread, read after it was joined
  std::thread thread_;
};

}  // namespace osteon::session
