#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace osteon::studies {

/// The events of an episode of a soak.
enum class EpisodeKind : std::uint8_t {
  kReference,     ///< always the same episode: other bits of the result show a drift
  kReaming,       ///< reaming with a drawn reamer and hand
  kLoss,          ///< lost and late datagrams of the arm
  kPause,         ///< an operator's pause and its end
  kRecovery,      ///< the arm falls silent for 60 ms; the loop starts again
  kSensorSilent,  ///< a part dies: the cell stops, and the next episode starts it again
  kDriveSilent,
  kPlcSilent,
  kArmSilent,
};
inline constexpr int kEpisodeKinds = 9;
[[nodiscard]] std::string_view NameOf(EpisodeKind kind);
/// The fault that the kind injects, by its name in a summary; empty: none.
[[nodiscard]] std::string_view InjectedFault(EpisodeKind kind);
/// Whether the kind's fault ends the run before its time.
[[nodiscard]] bool EndsWithFault(EpisodeKind kind);

/// One episode of a soak in virtual time: a run of the reaming scenario with its own overrides.
struct Episode {
  int index{0};
  EpisodeKind kind{EpisodeKind::kReference};
  double seconds{10.0};                ///< length of rendering
  double pause_s{0.0}, resume_s{0.0};  ///< begin and end of a pause, after rendering began
  std::vector<std::string> set{};      ///< KEY=VALUE each, overrides the cell

  /// "reaming, 51 mm, 23 s"
  std::string text{};
};

/// Length of a reference episode [s], and number of episodes from one reference to the next.
inline constexpr double kReference_s = 8.0;
inline constexpr int kEpisodesPerReference = 10;

/// The episode with an index in a soak of this seed: a function of its arguments alone. Every tenth is the
/// reference; the others are drawn.
[[nodiscard]] Episode EpisodeAt(std::uint64_t seed, int index);

}  // namespace osteon::studies
