#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "report/report.h"
#include "session/planning/plan.h"
#include "session/planning/planned_cell.h"
#include "session/procedure/session_file.h"
#include "session/replay/recorded_surface.h"
#include "session/run/cell_run.h"
#include "session/stops/stop_records.h"
#include "session/summary/event_row.h"
#include "session/summary/limit_rows.h"
#include "session/summary/run_accumulator.h"
#include "session/summary/verdict.h"

namespace osteon::session {

/// Median and tail of a duration, from the recording [s]. A count of 0 means: not measured (virtual time).
struct DurationFigures {
  std::size_t count{0};
  double p50_s{0.0}, p99_s{0.0}, p999_s{0.0}, max_s{0.0};
};
/// Computes the figures of counted durations.
[[nodiscard]] DurationFigures Quantiles(const report::DurationCounts& durations);

/// A change to coarser zones of the packing during a run. Its time counts from the run's start.
struct RezonedRow {
  double time_s{0.0};
  std::size_t balls{0};
  CoarserZones zones;
  double seen_us{0.0};  ///< median frame time that led to the coarsening
  std::string text;
};

/// Says in one to three words how a run ended.
[[nodiscard]] const char* EndText(control::RunEnd end);

/// The removed volume of a bone that was cut again from the recording, and the removed volume that the run
/// recorded.
struct RecutFigures {
  double removed_volume_m3{0.0}, recorded_volume_m3{0.0};
  /// The run's packing was planned, but the recording is too old to say how: the bone was packed as its scene
  /// says, and may differ from the run's.
  bool packing_unknown{false};
  [[nodiscard]] bool SameAsRecorded() const { return removed_volume_m3 == recorded_volume_m3; }
  /// Whether the volumes differ by so much that the bones must be different. Results of different engines
  /// differ by less.
  [[nodiscard]] bool Differs() const {
    return std::abs(removed_volume_m3 - recorded_volume_m3) > 1e-3 * recorded_volume_m3;
  }
};

/// The figures of a run, as the terminal, summary.json and the report show them.
struct RunSummary {
  std::string engine, device, scene, tool, recording, ended;
  std::optional<EngineProcessResult> engine_process{};  ///< absent: the engine was a thread of the run
  std::string recording_error;                          ///< why the recording is not complete; empty: it is
  std::string console_url{};                            ///< where the console was served; empty: nowhere
  std::string ended_by;               ///< the signal that asked for the end, "SIGHUP"; empty: none
  Verdict verdict;                    ///< result of JudgeRun
  std::vector<std::string> warnings;  ///< SetupWarnings, and the bone's own warning
  bool virtual_time{false};
  control::RunEnd end{control::RunEnd::kSeconds};
  double wanted_s{0.0};     ///< requested duration of rendering; 0: until the run is stopped
  double period_s{0.0};     ///< time of a tick
  bool without_plc{false};  ///< the cell has no PLC, so no permission to move is needed from one
  /// Wall time: scheduling that the system granted; absent for a recording, which does not state it.
  std::optional<rt::RealtimeGrant> servo_thread{rt::RealtimeGrant{}};
  std::size_t balls{0}, points{0};
  double seconds{0.0};  ///< time in COMMANDING_ACTIVE, without the time at rest at the end
  std::uint64_t ticks{0}, frames{0}, dropped{0};
  double servo_rate_hz{0.0};       ///< 1 / median period of the arm's messages in COMMANDING_ACTIVE
  double simulation_rate_hz{0.0};  ///< 1 / median interval between frames
  double peak_force_N{0.0}, peak_torque_Nm{0.0}, peak_sensor_force_N{0.0}, force_limit_N{0.0};
  double peak_tool_in_bone_m{0.0};  ///< largest distance from the commanded tool to its proxy
  double peak_power_W{0.0};         ///< largest power from the coupling into the hand
  /// Fraction of the rendering time in which the contact model was so old that it reduced the force.
  double stale_share{0.0};
  /// Fraction of the rendering time in which the sensor's reading was so old that it reduced the force.
  double sensor_late_share{0.0};
  double peak_tool_speed_m_per_s{0.0};           ///< commanded, while rendering
  double peak_measured_tool_speed_m_per_s{0.0};  ///< measured, while the arm was commanded
  /// cut_ticks: number of ticks in which any limit reduced the coupling's wrench; arm_cut_ticks: ticks in
  /// which the limits of the arm's joint torques alone would have reduced it. min_wrench_share and
  /// min_arm_share are the smallest fractions of the wrench in these two cases.
  std::uint64_t cut_ticks{0}, arm_cut_ticks{0};
  double min_wrench_share{1.0}, min_arm_share{1.0};
  /// Number of ticks in which each stabiliser acted, the extremes of the age governor's factors, and the
  /// tank's smallest energy while rendering.
  std::uint64_t age_governor_ticks{0}, passivity_ticks{0}, tank_ticks{0};
  double max_age_damping{1.0}, min_age_share{1.0}, min_tank_J{0.0};
  bool rendered{false};  ///< whether the loop rendered at any time; if not, there is no cut to report
  double removed_volume_m3{0.0}, removed_mass_kg{0.0}, cutting_work_J{0.0};
  double cutting_debt_J{0.0};  ///< CarvedState::cutting_debt_J at the end
  /// Volume of the solid swept by the proxy's cutting surface; measured on a grid, independently of the
  /// engine.
  double swept_volume_m3{0.0};
  /// Tolerance by which the proxy's path was thinned; 0: it contains each frame's pose.
  double swept_path_tolerance_m{0.0};
  double cup_depth_m{0.0};     ///< deepest proxy apex below the cup's uncut floor; negative: above it
  double reamed_depth_m{0.0};  ///< depth of the apex in the bone while it cut (simulation::ReamedDepth)
  double cavity_depth_m{0.0};  ///< depth of the cut floor below the uncut floor; < 0: carved through
  report::ReportFigures section;
  DurationFigures wakeup, compute, frame;
  LatencyFigures latency;                ///< latency of the whole cell, and its parts
  std::string state_hash;                ///< hash of the carved state, hexadecimal
  std::vector<EffectiveLimit> limits;    ///< the limits in force
  std::vector<ActedLimit> acted_limits;  ///< limits that acted, when and for how long
  double min_depth_left_m{0.0};  ///< smallest distance to the reamer's depth limit; infinite: no limit
  std::vector<report::FaultRow> faults;
  std::vector<DriveFaultRow> drive_faults;
  std::vector<EventRow> events;                ///< events of scene, pauses and deflections by time
  std::shared_ptr<const PlannedCell> planned;  ///< null: the bone was packed as the scene says, or loaded
  std::vector<RezonedRow> rezoned;             ///< zones that were coarsened
  std::optional<RecutFigures> recut;           ///< nothing: the bone was not cut again
  /// Thinnest wall beside the cut, 0: cut through; nothing: not watched.
  std::optional<double> min_wall_m;
  std::vector<std::string> assumptions;      ///< assumed figures: AssumedFigures, AssumedOfSimulation
  std::vector<std::string> identified;       ///< figures from `osteon identify` (IdentifiedText)
  PeakDeflection deflected;                  ///< largest displacements of tool, surface layer and mount
  double noticed_deflection_m{0.0};          ///< the cell's error; a larger displacement is an event
  std::vector<WrittenStop> stops;            ///< the stops that have a page
  std::optional<WrittenSurface> surface;     ///< nothing: not requested, or not written
  std::string config_checksum;               ///< checksum of the files that the cell was loaded from
  int recovered{0};                          ///< number of recoveries
  int operator_recoveries{0};                ///< number of recoveries that an operator requested
  std::vector<std::string> recovered_from;   ///< names of the faults that these recoveries cleared
  std::string cell_report;                   ///< report of the simulated cell, osteon.cell/1
  std::string session;                       ///< folder of a procedure's session; empty: none
  std::vector<SessionPass> passes;           ///< passes of the whole session
  std::vector<MissedChange> missed_changes;  ///< missed changes of the session's last run
  std::vector<double> diameters_mm;          ///< diameters of the session's tools
  control::TickInput link;                   ///< last tick's input, for its counts of messages
  std::string arm_stop;                      ///< why the simulated arm ended the session; empty: it did not
};

/// Computes the summary from the recording (`run`: ReadRun) and the carved state; the caller fills `section`
/// and `stops`.
[[nodiscard]] RunSummary Summarise(const CellSetup& setup, const simulation::CuttingEngine& engine,
                                   const CellRunParams& params, const CellRunResult& result,
                                   const RunAccumulator& run);

/// Returns the diameter of a tool of the run's session [mm].
/// @param tool_index  index from a pass or a missed change
[[nodiscard]] double ToolDiameterMm(const RunSummary& summary, int tool_index);

/// Makes the rows for the terminal and the report.
[[nodiscard]] std::vector<report::SummaryRow> Rows(const RunSummary& summary);

/// Prints the rows on the terminal, under `title`, scene and tool.
void PrintTable(const RunSummary& summary, const std::string& title);

/// Returns the exit code of a process that ran a cell: 0 done; 1 the run ended by a fault, an operator's
/// recovery ended a fault in it, or it never began; InterruptExitCode() after a signal.
[[nodiscard]] int ExitCode(const CellRunResult& result);

/// Says why a run has no complete recording: the recorder's reason, and the reader's. Empty: its recording is
/// complete.
[[nodiscard]] std::string DescribeRecordingErrors(const CellRunResult& result, const std::string& unreadable);
/// Appends a reason: "before; reason", or the reason alone.
void AddReason(std::string& reasons, const std::string& reason);

/// Makes the JSON object that docs/commands.md specifies, with `schema`.
[[nodiscard]] std::string ToJson(const RunSummary& summary, const std::string& schema);

}  // namespace osteon::session
