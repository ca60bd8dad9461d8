#pragma once

#include <span>
#include <string>
#include <vector>

#include "studies/soak/episode_books.h"
#include "studies/soak/soak.h"
#include "studies/soak/wall_cell.h"
#include "studies/soak/wall_script.h"

namespace osteon::studies {

/// The outcome of an episode in wall time.
struct WallResult {
  WallEpisode episode;
  WallOutcome outcome;
  std::string ended{};  ///< how the run ended, by the controller's summary; empty: it was killed
  std::vector<std::string> faults{};  ///< names, in their order
  std::string late_text{};            ///< the values at the faults, and how late the loop was woken
  std::uint64_t ticks{0};             ///< by the summary
  std::uint64_t dropped_records{0};
  double removed_mm3{0.0};     ///< by the summary
  double depth_mm{0.0};        ///< reamed, by the summary
  double cutting_debt_J{0.0};  ///< by the summary
  std::size_t passes{0};       ///< of a procedure, by the summary
  EpisodeBooks books{};
  std::vector<std::string> wrong{};  ///< errors of the episode; empty: none

  /// See EpisodeBooks::EnergyResidual; valid for an episode that ended by itself.
  [[nodiscard]] double energy_residual() const { return books.EnergyResidual(cutting_debt_J); }
};

/// Bounds of a soak in wall time, beside those of an episode in virtual time (soak.h).
/// Accepted relative difference of the removed volume, and of the depth, between two runs of the same
/// reaming: the hand's script and the loop are not synchronised, so each run differs a little.
inline constexpr double kMaxVolumeDrift = 0.01;
inline constexpr double kMaxDepthDrift_mm = 0.1;
/// Bounds of the watchdogs plus a tick or two: a watchdog acts in the tick that finds the age beyond its
/// bound.
inline constexpr double kMaxModelAge_s = 0.252, kMaxSensorAge_s = 0.102;

/// Lists the errors of an episode. @param first  the first undisturbed reaming; null: this one is the first
[[nodiscard]] std::vector<std::string> JudgeWallEpisode(const WallResult& result, const WallResult* first);

/// Growth of a process's use from the second to the last quarter of the episodes of ordinary length: memory
/// [MB] by the medians, open files and threads by the minima; zeros with fewer than eight episodes.
struct UseGrowth {
  double memory_MB{0.0};
  int files{0}, threads{0};
};
[[nodiscard]] UseGrowth GrowthOf(WallPart part, std::span<const WallResult> results);

/// Names each part that grows beyond kMaxMemoryGrowth_MB, or by more than one file or thread.
[[nodiscard]] std::vector<std::string> JudgeGrowth(std::span<const WallResult> results);

/// JSON object, schema osteon.soak.wall/1.
[[nodiscard]] std::string WallSoakJson(std::span<const WallResult> results, const SoakOptions& options);

/// One page: verdict, figures, plots over the hours, and the episodes by event.
[[nodiscard]] std::string WallSoakPage(std::span<const WallResult> results, const SoakOptions& options);

/// Runs `osteon soak --wall`.
/// @returns the process's exit code, as RunSoak's.
[[nodiscard]] int RunWallSoak(const SoakOptions& options);

}  // namespace osteon::studies
