#pragma once

#include <span>
#include <string>
#include <vector>

#include "studies/soak/episode_figures.h"
#include "studies/soak/soak.h"
#include "studies/soak/wall_cell.h"
#include "studies/soak/wall_script.h"

namespace osteon::studies {

/// The outcome of an episode in wall time.
struct WallResult {
  WallEpisode episode;
  WallOutcome outcome;
  /// How the run ended, from the controller's summary; empty: the controller was killed.
  std::string ended{};
  std::vector<std::string> faults{};  ///< names, in the order in which they occurred
  std::string late_text{};            ///< the values that caused the faults, and how late the loop was woken
  std::uint64_t ticks{0};             ///< from the summary
  std::uint64_t dropped_records{0};
  double removed_mm3{0.0};     ///< from the summary
  double depth_mm{0.0};        ///< reamed depth, from the summary
  double cutting_debt_J{0.0};  ///< cutting debt at the end, from the summary
  std::size_t passes{0};       ///< passes of a procedure, from the summary
  EpisodeFigures figures{};
  std::vector<std::string> wrong{};  ///< errors of the episode; empty: none

  /// See EpisodeFigures::EnergyResidual; valid for an episode that ended by itself.
  [[nodiscard]] double energy_residual() const { return figures.EnergyResidual(cutting_debt_J); }
};

/// Bounds of a soak in wall time, in addition to those of an episode in virtual time (soak.h): accepted
/// differences of the removed volume (relative) and of the depth between two runs of the same reaming. The
/// hand's script and the loop are not synchronised, so each run differs a little.
inline constexpr double kMaxVolumeDrift = 0.01;
inline constexpr double kMaxDepthDrift_mm = 0.1;
/// Largest accepted ages: the bounds of the watchdogs plus a tick or two. A watchdog acts in the tick in
/// which the age exceeds its bound.
inline constexpr double kMaxModelAge_s = 0.252, kMaxSensorAge_s = 0.102;

/// Lists the errors of an episode. @param first  the first undisturbed reaming, for comparison; null: this
/// episode is the first
[[nodiscard]] std::vector<std::string> JudgeWallEpisode(const WallResult& result, const WallResult* first);

/// Growth of a process's use of the machine from the second to the last quarter of the episodes of ordinary
/// length. Memory [MB] is compared by the medians, the numbers of open files and threads by the minima. Zeros
/// with fewer than eight episodes.
struct UseGrowth {
  double memory_MB{0.0};
  int files{0}, threads{0};
};
[[nodiscard]] UseGrowth GrowthOf(WallPart part, std::span<const WallResult> results);

/// Names each process that grows by more than kMaxMemoryGrowth_MB, or by more than one file or thread.
[[nodiscard]] std::vector<std::string> JudgeGrowth(std::span<const WallResult> results);

/// JSON object, schema osteon.soak.wall/1.
[[nodiscard]] std::string WallSoakJson(std::span<const WallResult> results, const SoakOptions& options);

/// One page: verdict, figures, plots over the hours, and the episodes by event.
[[nodiscard]] std::string WallSoakPage(std::span<const WallResult> results, const SoakOptions& options);

/// Runs `osteon soak --wall`.
/// @returns the process's exit code, as RunSoak's.
[[nodiscard]] int RunWallSoak(const SoakOptions& options);

}  // namespace osteon::studies
