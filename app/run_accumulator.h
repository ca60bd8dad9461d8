#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "app/cell_setup.h"
#include "app/drive_fault_rows.h"
#include "app/limit_rows.h"
#include "app/pause_events.h"
#include "app/report/run_curves.h"
#include "app/stop_records.h"
#include "simulation/metrics/cut_metrics.h"
#include "simulation/tools/proxy_path.h"

namespace osteon::app {

/// The ticks of a run that the arm answered to (COMMANDING_ACTIVE).
struct ActiveTicks {
  void Add(const control::TickRecord& tick);

  double fresh_s{0.0}, sensor_full_s{0.0};     ///< ages up to which model and sensor count in full
  std::optional<rt::Nanoseconds> first, last;  ///< stamps
  rt::Nanoseconds stopped_at{0};               ///< of the last in which the loop was not at rest after a stop
  DurationCounts step, wakeup, compute;        ///< step: from one stamp to the next
  /// Ticks in which a limit cut off a part of the coupling's wrench, and those in which the arm's torques
  /// would have; and the least shares that were rendered and that the arm could hold.
  std::uint64_t cut{0}, arm_cut{0};
  double min_wrench_share{1.0}, min_arm_share{1.0};
  /// Ticks in which a stabiliser acted, and how far it went.
  std::uint64_t age_governor{0}, passivity{0}, tank{0};
  double max_age_damping{1.0}, min_age_share{1.0};
  std::uint64_t rendering{0}, stale{0},
      sensor_late{0};  ///< ticks: all, and those with an older model, sensor
};

/// Everything that a run's end takes from its recording, gathered in one pass, tick by tick and frame by
/// frame. Memory does not grow with the run, but for a few bytes each time the phase changes: what is listed
/// is counted (DurationCounts), thinned (RunCurves, ProxyPath) or kept of the first and the last only.
struct RunAccumulator {
  explicit RunAccumulator(const CellSetup& setup);
  void Add(const control::TickRecord& tick);
  void Add(const simulation::FrameRecord& frame);

  RunCurves curves;
  simulation::ProxyPath path;

  // of the ticks
  std::uint64_t ticks{0};
  ActiveTicks active;
  ActedLimits limits;
  DriveFaultRows drive_faults;
  PauseEvents pauses;
  std::map<safety::Fault, control::TickRecord> first_with;  ///< the first tick that has each fault
  std::uint32_t seen_faults{0};                             ///< those that are in it, as bits
  control::TickInput last_input;

  // of the frames
  std::uint64_t frames{0};
  DurationCounts frame_step;  ///< from one stamp to the next
  std::optional<rt::Nanoseconds> last_frame;
  simulation::ReamedDepth reamed;
  double cup_depth_m{0.0};  ///< the last one's
};

/// One pass through a recording; its ticks and events go to `stops` as well.
/// The error names the file, the byte and the reason.
[[nodiscard]] tl::expected<RunAccumulator, std::string> ReadRun(const std::filesystem::path& recording,
                                                                const CellSetup& setup, StopPages& stops);

}  // namespace osteon::app
