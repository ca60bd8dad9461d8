#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "studies/soak/episode_figures.h"
#include "studies/soak/soak_script.h"

namespace osteon::studies {

/// Options of `osteon soak`.
struct SoakOptions {
  std::filesystem::path config_root;
  double hours{8.0};  ///< duration in virtual time; with --wall in wall time
  std::uint64_t seed{1};
  std::filesystem::path out{};   ///< folder for soak.html; empty: none
  std::filesystem::path json{};  ///< empty: none
  std::string command_line{};
};

/// The outcome of an episode in virtual time.
struct EpisodeResult {
  Episode episode;
  std::string ended;                ///< how the run ended: "completed" or "fault"
  std::vector<std::string> faults;  ///< names, in the order in which they occurred
  std::uint64_t hash{0};            ///< hash over every bit of every tick and of the carved bone
  EpisodeFigures figures;
  double carved_m3{0.0};  ///< removed volume according to the engine's final state
  /// Cutting debt at the end: work for cleared bone that the edge has not yet done; negative: work done for
  /// bone that is not yet cleared.
  double cutting_debt_J{0.0};
  double seconds_simulated{0.0}, seconds_wall{0.0};
  double memory_MB{0.0};             ///< resident memory after the episode
  std::vector<std::string> wrong{};  ///< errors of the episode; empty: none

  /// See EpisodeFigures::EnergyResidual.
  [[nodiscard]] double energy_residual() const { return figures.EnergyResidual(cutting_debt_J); }
};

/// Bounds that every episode must keep: the momentum residual as a share of the hand's impulse; the energy
/// residual as a share of the cleared bone's energy; the distance from the command at rest; the rendered
/// force; and the difference of the recorded from the carved volume, as a share of the carved volume.
inline constexpr double kMaxMomentumResidual = 0.02, kMaxEnergyResidual = 0.01, kMaxRestError_m = 0.5e-3,
                        kMaxForce_N = 200.0, kMaxVolumeResidual = 1e-9;
/// Accepted difference between the edge's work and the cleared energy. While the spindle starts or stops, its
/// speed changes within a frame, so the computed work has an error.
inline constexpr double kMaxEnergyOpen_J = 1.0;
/// Largest volume that one frame can clear: six mass points of the soak's cell.
inline constexpr double kMaxUnseenFrame_m3 = 20e-9;
/// Accepted growth of the memory from the second to the last quarter of the episodes, as the difference of
/// the two medians.
inline constexpr double kMaxMemoryGrowth_MB = 20.0;

/// Whether the edge's work equals the energy of the cleared bone plus or minus the cutting debt.
/// @param debt_J  see EpisodeFigures::EnergyResidual
[[nodiscard]] bool EnergyCloses(const EpisodeFigures& figures, double debt_J);
/// The energies that EnergyCloses compares, as a sentence for a report.
[[nodiscard]] std::string EnergyText(const EpisodeFigures& figures, double debt_J);

/// Lists the errors of an episode. @param reference_hash  hash of the first reference episode; 0: this is the
/// first
[[nodiscard]] std::vector<std::string> JudgeEpisode(const EpisodeResult& result,
                                                    std::uint64_t reference_hash);

/// Growth of the memory [MB]; 0 with fewer than eight episodes.
[[nodiscard]] double MemoryGrowth_MB(std::span<const EpisodeResult> episodes);

/// Runs episodes until options.hours of virtual time have passed. @param done  called after each episode
/// @returns an error if an episode could not be run at all.
[[nodiscard]] tl::expected<std::vector<EpisodeResult>, std::string> RunEpisodes(
    const SoakOptions& options, const std::atomic<bool>* stop,
    const std::function<void(const EpisodeResult&)>& done);

/// JSON object, schema osteon.soak/1.
[[nodiscard]] std::string SoakJson(std::span<const EpisodeResult> episodes, const SoakOptions& options);

/// Runs `osteon soak`.
/// @returns the process's exit code: 0; 1 an episode had an error, the memory grew, or a file could not be
/// written; 2 bad input; 130 ended by Ctrl-C, with the finished episodes written.
[[nodiscard]] int RunSoak(const SoakOptions& options);

}  // namespace osteon::studies
