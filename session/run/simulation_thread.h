#pragma once

#include <atomic>
#include <string>
#include <thread>

#include "base/latest_value.h"
#include "io/recording/recorder.h"
#include "session/run/frame_runner.h"

namespace osteon::session {

/// Runs the simulation in wall time, in its own thread and at its own rate: takes the newest command from
/// `commands`, and writes a new contact model to `models`.
class SimulationThread {
 public:
  SimulationThread(FrameRunner& runner, rt::LatestValue<simulation::ToolCommand>& commands,
                   rt::LatestValue<simulation::ContactModel>& models, io::Recorder& recorder);
  ~SimulationThread();
  SimulationThread(const SimulationThread&) = delete;
  SimulationThread& operator=(const SimulationThread&) = delete;

  /// Ends the thread after the present frame. Safe to call twice.
  void Stop();
  /// After Stop: the exception that ended the thread early; empty if there was none. After such an end no new
  /// models come.
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  void Loop();

  FrameRunner& runner_;
  rt::LatestValue<simulation::ToolCommand>& commands_;
  rt::LatestValue<simulation::ContactModel>& models_;
  io::Recorder& recorder_;
  std::atomic<bool> stop_{false};
  std::string error_;  // written by the thread, read after it was joined
  std::thread thread_;
};

}  // namespace osteon::session
