#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <tl/expected.hpp>

#include "report/run_curves.h"
#include "session/procedure/procedure_tools.h"
#include "session/procedure/session_cut.h"
#include "session/setup/cell_setup.h"
#include "session/stops/stop_records.h"
#include "session/summary/deflection_events.h"
#include "session/summary/drive_fault_rows.h"
#include "session/summary/latency.h"
#include "session/summary/limit_rows.h"
#include "session/summary/pause_events.h"
#include "simulation/removal/cut_metrics.h"
#include "simulation/tools/proxy_path.h"

namespace osteon::session {

class ProcedureSession;

/// Figures of the ticks in which the arm was commanded (COMMANDING_ACTIVE).
struct ActiveTicks {
  void Add(const control::TickRecord& tick);

  double fresh_s{0.0}, sensor_full_s{0.0};     ///< ages of model and reading up to which force is full
  std::optional<rt::Nanoseconds> first, last;  ///< stamps of the first and the last such tick
  /// Stamp of the last tick in which the loop was not yet at rest after a stop.
  rt::Nanoseconds stopped_at{0};
  report::DurationCounts step, wakeup, compute;  ///< step: from one tick's stamp to the next
  /// cut: number of ticks in which any limit reduced the coupling's wrench; arm_cut: ticks in which the
  /// limits of the arm's joint torques alone would have reduced it. min_wrench_share and min_arm_share are
  /// the smallest fractions of the wrench in these two cases.
  std::uint64_t cut{0}, arm_cut{0};
  double min_wrench_share{1.0}, min_arm_share{1.0};
  /// Number of ticks in which each stabiliser acted, and the extremes of the age governor's factors on
  /// damping and on the coupling.
  std::uint64_t age_governor{0}, passivity{0}, tank{0};
  double max_age_damping{1.0}, min_age_share{1.0};
  std::uint64_t rendering{0}, stale{0},
      sensor_late{0};  ///< rendering ticks: all; those with an old model; with an old reading
};

/// Gathers everything that a run's summary needs from its recording, in one pass over ticks and frames.
/// Memory does not grow with the run, except for a few bytes per change of phase: series are counted
/// (DurationCounts), thinned (RunCurves, ProxyPath), or only their first and last values are kept.
struct RunAccumulator {
  explicit RunAccumulator(const CellSetup& setup);
  /// Sets a procedure's tools: depths are then computed for the tool in use.
  /// @param first  index of the tool that is in use at the beginning
  void UseTools(const CellSetup& setup, std::span<const ProcedureTool> tools, int first);
  void Add(const control::TickRecord& tick);
  void Add(const simulation::FrameRecord& frame);

  report::RunCurves curves;
  simulation::ProxyPath path;

  // gathered from the ticks
  std::uint64_t ticks{0};
  ActiveTicks active;
  ActedLimits limits;
  DriveFaultRows drive_faults;
  LatencyMeter latency;
  PauseEvents pauses;
  DeflectionEvents deflections;
  PeakDeflection deflected;
  std::map<safety::Fault, control::TickRecord> first_with;  ///< for each fault, the first tick that has it
  std::uint32_t seen_faults{0};                             ///< the keys of first_with, as bits
  control::TickInput last_input;

  // gathered from the frames
  std::uint64_t frames{0};
  report::DurationCounts frame_step;  ///< time from one frame's stamp to the next
  std::optional<rt::Nanoseconds> last_frame;
  simulation::ReamedDepth reamed;
  double cup_depth_m{0.0};  ///< cup depth in the last frame

  /// Tools and paths of a procedure's passes; null: a run of one tool, which has cut along `path`.
  std::shared_ptr<const SessionCut> session_cut{};

 private:
  std::shared_ptr<int> tool_in_use_{};  // read by curves.depth_of; null: there is only one tool
};

/// Reads a recording in one pass; its ticks and events go to `stops` as well.
/// The error names the file, the byte and the reason.
/// @param procedure  the procedure whose run was recorded; null: none
[[nodiscard]] tl::expected<RunAccumulator, std::string> ReadRun(const std::filesystem::path& recording,
                                                                const CellSetup& setup, StopPages& stops,
                                                                const ProcedureSession* procedure = nullptr);

}  // namespace osteon::session
