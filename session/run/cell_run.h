#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "base/interrupt.h"
#include "control/loop/run_servo.h"
#include "io/engine/engine_ports.h"
#include "io/recording/recorder.h"
#include "session/run/adaptive_resolution.h"
#include "session/run/cell_process.h"
#include "session/setup/cell_setup.h"
#include "simulation/bone/scene_events.h"
#include "simulation/surface/surface_thread.h"

namespace osteon::session {

class GainsPanel;
class ProcedureSession;
class RemoteEngine;

/// The parameters of a run, and the parts of the program that take part in it.
struct CellRunParams {
  double seconds{10.0};  ///< duration of rendering; 0: until stopped (wall time only)
  bool virtual_time{false};
  double frame_s{0.002};  ///< virtual time: interval between frames, and delay from pose to model
  /// Virtual time passes at most this many times as fast as real time; 0: as fast as the machine can. The
  /// results are the same.
  double real_time_factor{0.0};
  int recoveries{0};  ///< largest number of automatic restarts after lost connections to the arm
  /// True: after a fault that allows a recovery, the arm stays at rest until `requests` contains a recovery
  /// or a stop. False: the fault ends the run.
  bool hold_at_fault{false};
  double wait_s{30.0};  ///< wall time: if rendering has not begun by then, the run ends
  /// Time for which the arm is still answered and recorded once it has come to rest at the end. Not used if
  /// the arm's program can be asked to end (CanRequestStop).
  double at_rest_s{0.5};
  int cpu{-1};  ///< wall time: CPU to which the servo thread is pinned; -1: any
  /// Wall time: the simulated cell to start as a process of its own; absent: connected devices are used.
  std::optional<CellProcessParams> cell{};
  /// The engine, if it runs in another process. In wall time the servo loop then exchanges messages with that
  /// process itself. Null: a thread of this process steps the engine.
  RemoteEngine* remote{nullptr};
  std::filesystem::path recording;  ///< the MCAP file to write
  /// Called after everything could be opened and the recording's folder exists, before the recording is made
  /// or overwritten. @returns the reason if the recording must not be made; else empty.
  std::function<std::string()> make_room{};
  const std::atomic<bool>* stop{nullptr};     ///< becomes true if the run is to end in order; null: never
  base::OperatorRequests* requests{nullptr};  ///< an operator's pause, resume, recovery; null: none
  io::RecordSink* live{nullptr};              ///< a live view, which gets all records; null: none
  std::string console_url{};                  ///< address of the console, for the summary; empty: not served
  std::filesystem::path gains{};     ///< a file of gains that is read again whenever it is saved; empty: none
  GainsPanel* gains_panel{nullptr};  ///< gains that pages request; null: none
  /// Log time between two states of the carved bone in the recording, for Foxglove; 0: no states are
  /// recorded.
  double bone_state_s{0.0};
  std::function<void()> begins{};  ///< called once everything is open, before anything moves
  std::function<void(const std::string&)> notice{};  ///< called with a line of text for each notable event
  std::function<void(double seconds)> progress{};    ///< called now and then with the time run so far
  /// A procedure with its tools and saved states, after its Begin; null: none. It must outlive the run.
  ProcedureSession* procedure{nullptr};
  /// Coarsens the zones during the run if frames take too long; null: the zones stay.
  AdaptiveResolution* adaptive_resolution{nullptr};
  /// Updates the carved surface and passes it to its sink, on a thread of its own; null: no surface is shown.
  surface::SurfaceThread* surface{nullptr};
  /// Virtual time: assumed computing time of a frame [us], for the adaptive resolution; empty: zones are not
  /// coarsened.
  std::function<double(const simulation::FrameRecord&)> frame_us{};
  /// Virtual time: called after each tick with the contact model that the tick used.
  std::function<void(const control::TickRecord&, const simulation::ContactModel&)> ticked{};
};

/// Wall time: a message of the arm counts as missed after this many of its periods. Virtual time: after one.
inline constexpr double kArmDeadlinePeriods = 5.0;

/// How an engine in another process has ended.
struct EngineProcessResult {
  std::string where;  ///< "local, process 1234" or "127.0.0.1:30300"
  io::EngineCounters counters;
  std::string ended{};      ///< why its process ended during the run: "signal 9 (Killed)"; empty: it did not
  std::string unfetched{};  ///< why its carved state was not fetched but cut again; empty: it was fetched
};

/// The result of a run, apart from its recording.
struct CellRunResult {
  control::RunEnd end{control::RunEnd::kSeconds};
  std::string diagnosis;  ///< if rendering never began: what prevented it, in the arm or the devices
  safety::FaultSet faults;
  control::ServoStatistics statistics;
  int recovered{0};                ///< number of automatic restarts, without recoveries by an operator
  int operator_recoveries{0};      ///< number of restarts that an operator requested at a fault
  safety::FaultSet cleared;        ///< faults that the operator's recoveries have cleared
  rt::RealtimeGrant servo_thread;  ///< wall time: scheduling that the system granted
  io::RecordingCounts recording;
  std::string recording_error;  ///< why the recording could not be written to its end; empty: it is complete
  std::optional<EngineProcessResult> engine_process;  ///< absent: the engine ran in this process
  std::string session_error;   ///< why a procedure's session could not be written; empty: it was
  std::string internal_error;  ///< an exception that stopped the run in order; empty: none
  simulation::CarvedState after;
  std::vector<Rezoned> rezoned;  ///< zones that were coarsened; `after` is a state of the last coarser bone
  std::vector<simulation::SceneEvent> events;  ///< events of the scene, with the stamps of the recording
  std::optional<double> min_wall_m;            ///< thinnest wall beside the cut; nothing: not watched
  std::string cell_report;  ///< report of the simulated cell, osteon.cell/1; empty: this run did not start it
};

/// The reason why there is no result.
struct CellRunError {
  std::string what;
  bool begun{false};  ///< false: the run was refused before it began, and there is no recording
};

/// Operates a cell: servo loop, cutting engine, and the devices that are connected.
///
/// In wall time, servo loop and simulation have threads of their own. Arm, force sensor, spindle and PLC are
/// behind their protocols; they are real, or simulated in a separate process.
///
/// In virtual time, the simulated cell is part of this process and everything runs in lockstep in the calling
/// thread, with the same datagrams and frames passed in memory. The simulation takes a command every frame_s.
/// Its result becomes visible to the loop frame_s later (at least one tick), as if the frame had taken that
/// long.
///
/// The recording's folder is created if needed. If a recording can't be written to its end (a full disk), the
/// run continues and its result says so. The error says what could not be opened or started.
[[nodiscard]] tl::expected<CellRunResult, CellRunError> RunCell(const CellSetup& setup,
                                                                simulation::CuttingEngine& engine,
                                                                const CellRunParams& params);

}  // namespace osteon::session
