#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "app/cell_setup.h"
#include "control/run_servo.h"
#include "hil/simulated_cell_thread.h"
#include "io/recording/recorder.h"
#include "simulation/scene_events.h"

namespace osteon::app {

struct CellRunParams {
  double seconds{10.0};  ///< of COMMANDING_ACTIVE
  bool virtual_time{false};
  std::filesystem::path recording;  ///< the MCAP file to write
  const std::atomic<bool>* stop{nullptr};
  std::function<void(double seconds)> progress{};  ///< called now and then with the time run so far
};

/// What a run leaves besides its recording.
struct CellRunResult {
  control::RunEnd end{control::RunEnd::kSeconds};
  std::string
      diagnosis;  ///< where the arm was never ready: what kept it from being commanded, if that is known
  safety::FaultSet faults;
  control::ServoStatistics statistics;
  bool realtime{false};
  io::RecordingCounts recording;
  simulation::CarvedState after;
  std::vector<simulation::SceneEvent> events;  ///< stamps as in the recording
  std::optional<double> least_wall_m;  ///< that was left beside the cut; nothing where none is watched
  hil::CellState cell;
};

/// Runs the simulated cell: arm over FRI, operator, servo loop and cutting engine.
///
/// In wall time the arm is a thread behind a real UDP socket on loopback, the servo loop and the simulation
/// have threads of their own. In virtual time all of it runs in lockstep in the calling thread, the same
/// datagrams handed over in memory: the simulation takes every second tick's command and its frame is seen
/// two ticks later, as a 500 Hz simulation's would. The recording's folder is made where it is not there. The
/// error says what could not be opened.
[[nodiscard]] tl::expected<CellRunResult, std::string> RunCell(const CellSetup& setup,
                                                               simulation::CuttingEngine& engine,
                                                               const CellRunParams& params);

}  // namespace osteon::app
