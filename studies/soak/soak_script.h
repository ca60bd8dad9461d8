#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace osteon::studies {

/// The kinds of episodes of a soak.
enum class EpisodeKind : std::uint8_t {
  /// Always the same episode: if its result changes in any bit, the program's state has drifted.
  kReference,
  kReaming,       ///< reaming with a drawn reamer and hand
  kLoss,          ///< datagrams of the arm are lost or late
  kPause,         ///< an operator's pause and its end
  kRecovery,      ///< the arm falls silent for 60 ms; the loop recovers
  kSensorSilent,  ///< a part falls silent for good: the cell stops, and the next episode starts it again
  kDriveSilent,
  kPlcSilent,
  kArmSilent,
};
inline constexpr int kEpisodeKinds = 9;
[[nodiscard]] std::string_view NameOf(EpisodeKind kind);
/// The fault that the kind injects, by the name that a summary gives it; empty: none.
[[nodiscard]] std::string_view InjectedFault(EpisodeKind kind);
/// Whether the kind's fault ends the run early.
[[nodiscard]] bool EndsWithFault(EpisodeKind kind);

/// One episode of a soak in virtual time: a run of the reaming scenario with some overrides.
struct Episode {
  int index{0};
  EpisodeKind kind{EpisodeKind::kReference};
  double seconds{10.0};                ///< time of rendering
  double pause_s{0.0}, resume_s{0.0};  ///< begin and end of a pause, since rendering began
  std::vector<std::string> set{};      ///< KEY=VALUE each, overrides the cell

  /// "reaming, 51 mm, 23 s"
  std::string text{};
};

/// Length of a reference episode [s], and number of episodes from one reference to the next.
inline constexpr double kReference_s = 8.0;
inline constexpr int kEpisodesPerReference = 10;

/// The episode with an index in a soak of this seed; it depends only on the two arguments. Every tenth
/// episode is the reference; the others are drawn at random.
[[nodiscard]] Episode EpisodeAt(std::uint64_t seed, int index);

}  // namespace osteon::studies
