#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "app/cell_process.h"
#include "app/cell_setup.h"
#include "app/interrupt.h"
#include "app/zone_governor.h"
#include "control/run_servo.h"
#include "io/recording/recorder.h"
#include "simulation/scene_events.h"

namespace osteon::app {

struct CellRunParams {
  double seconds{10.0};  ///< of rendering; 0: until stopped (wall time)
  bool virtual_time{false};
  double frame_s{0.002};  ///< virtual time: from one frame to the next, and from its pose to its model
  int recoveries{0};  ///< so often the loop begins again after the connection to the arm has ended rendering
  double wait_s{30.0};  ///< wall time: without beginning to render; then the run ends
  /// The arm is answered and recorded so long after it has come to rest at the end; not one whose program is
  /// asked to end then (CanAskToEnd).
  double at_rest_s{0.5};
  int cpu{-1};  ///< wall time: the servo thread is pinned to it; -1: any
  /// Wall time: the simulated cell to start as a process of its own; absent: what is at the wires is used.
  std::optional<CellProcessParams> cell{};
  std::filesystem::path recording;  ///< the MCAP file to write
  /// Called where all could be opened and the recording's folder is there, before the recording is made or
  /// overwritten. @returns why it must not be; empty where it may.
  std::function<std::string()> make_room{};
  const std::atomic<bool>* stop{nullptr};
  PauseSignals* pauses{nullptr};   ///< an operator's pause and its end; null: nobody asks
  std::filesystem::path gains{};   ///< a file of gains that is read again whenever it is saved; empty: none
  std::function<void()> begins{};  ///< called once all is open, before anything moves
  std::function<void(const std::string&)> notice{};  ///< told in a line what has happened meanwhile
  std::function<void(double seconds)> progress{};    ///< called now and then with the time run so far
  ZoneGovernor* governor{nullptr};  ///< of the zones, while it runs; null: they stay as they are
  /// Virtual time: what a frame is said to have taken [us], for the governor; empty: nothing.
  std::function<double(const simulation::FrameRecord&)> frame_us{};
  /// Virtual time: told each tick with the contact model that it saw.
  std::function<void(const control::TickRecord&, const simulation::ContactModel&)> ticked{};
};

/// In wall time a message of the arm is missed after so many of its periods; in virtual time after one.
inline constexpr double kArmDeadlinePeriods = 5.0;

/// What a run leaves besides its recording.
struct CellRunResult {
  control::RunEnd end{control::RunEnd::kSeconds};
  std::string diagnosis;  ///< where rendering never began: what kept arm or devices from it
  safety::FaultSet faults;
  control::ServoStatistics statistics;
  int recovered{0};                ///< times that it began again
  rt::RealtimeGrant servo_thread;  ///< wall time: what the system granted it
  io::RecordingCounts recording;
  std::string recording_error;  ///< it could not be written to its end, and why; empty where it was
  std::string internal_error;   ///< an exception that stopped the run in order; empty: there was none
  simulation::CarvedState after;
  std::vector<Rezoned> rezoned;  ///< zones that were coarsened; `after` is of the last one's bone
  std::vector<simulation::SceneEvent> events;  ///< stamps as in the recording
  std::optional<double> least_wall_m;  ///< that was left beside the cut; nothing where none is watched
  std::string cell_report;  ///< what the simulated cell says of itself, osteon.cell/1; empty: not ours
};

/// Why there is no result.
struct CellRunError {
  std::string what;
  bool begun{false};  ///< it failed while it ran; else it was refused before, and left no recording
};

/// Operates a cell: servo loop and cutting engine, and what is on the cell's wires.
///
/// In wall time servo loop and simulation have threads of their own; arm, force sensor, spindle and PLC are
/// behind their protocols, real, or simulated in a process of their own. In virtual time the simulated cell
/// is part of this process and all of it runs in lockstep in the calling thread, the same datagrams and
/// frames handed over in memory: the simulation takes a command every frame_s and its frame is seen so much
/// later (a tick at least), as a simulation's would that takes so long. The recording's folder is made where
/// it is not there. A recording that can't be written to its end (a full disk) ends no run: its result says
/// so. The error says what could not be opened or started.
[[nodiscard]] tl::expected<CellRunResult, CellRunError> RunCell(const CellSetup& setup,
                                                                simulation::CuttingEngine& engine,
                                                                const CellRunParams& params);

}  // namespace osteon::app
