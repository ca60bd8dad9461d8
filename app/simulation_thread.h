#pragma once

#include <atomic>
#include <string>
#include <thread>

#include "app/frame_runner.h"
#include "control/rt/latest_value.h"
#include "io/recording/recorder.h"

namespace osteon::app {

/// The simulation in wall time: its own thread, at its own rate, from the newest command to a new contact
/// model. Reader of `commands`, writer of `models`.
class SimulationThread {
 public:
  SimulationThread(FrameRunner& runner, rt::LatestValue<simulation::ToolCommand>& commands,
                   rt::LatestValue<simulation::ContactModel>& models, io::Recorder& recorder);
  ~SimulationThread();
  SimulationThread(const SimulationThread&) = delete;
  SimulationThread& operator=(const SimulationThread&) = delete;

  /// Ends after the present frame. Safe to call twice.
  void Stop();
  /// After Stop: the exception that ended it before; empty where none did. Its models then grew old.
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  void Loop();

  FrameRunner& runner_;
  rt::LatestValue<simulation::ToolCommand>& commands_;
  rt::LatestValue<simulation::ContactModel>& models_;
  io::Recorder& recorder_;
  std::atomic<bool> stop_{false};
  std::string error_;  // the thread's, until it was joined
  std::thread thread_;
};

}  // namespace osteon::app
