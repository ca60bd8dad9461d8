#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace osteon::studies {

/// The events of an episode of a soak in wall time.
enum class WallEvent : std::uint8_t {
  kReaming,         ///< nothing but the reaming
  kPause,           ///< pauses that an operator asks for, and their ends
  kPages,           ///< pages leave and come back all the time
  kHaltedCell,      ///< the cell's process is halted for some ms; the loop starts again
  kTools,           ///< the procedure of a plan: its four reamers in turn, each taken in a pause
  kLong,            ///< a long reaming with a pause in each quarter
  kControllerKill,  ///< SIGKILL to `osteon run`
  kGuardKill,       ///< SIGKILL to `osteon guard`
  kEngineKill,      ///< SIGKILL to `osteon simulate`, the engine in its own process
  kCellKill,        ///< SIGKILL to `osteon cell`: arm, sensor, drive and PLC are gone
};
inline constexpr int kWallEvents = 10;
[[nodiscard]] std::string_view NameOf(WallEvent event);
[[nodiscard]] bool IsKill(WallEvent event);

/// One cell's process and its guard, which live through several episodes.
struct CellLife {
  int index{0};
  double loss_ratio{0.0};      ///< share of the arm's datagrams that are lost, in both directions
  bool engine_process{false};  ///< the engine is a process of its own
  bool plan{false};            ///< the operator's hand follows the plan
  double seconds{0.0};         ///< length of the operator's script
};

/// A pause; its begin counts from the begin of rendering.
struct WallPause {
  double begin_s{0.0}, length_s{0.0};
  bool next_tool{false};  ///< the plan's next tool is taken during the pause
};

/// One episode of a soak in wall time.
struct WallEpisode {
  int index{0};
  CellLife life;
  WallEvent event{WallEvent::kReaming};
  double seconds{0.0};              ///< length of rendering
  double at_s{0.0};                 ///< rendered time at which a kill or a halt takes place
  double halt_s{0.0};               ///< length of a halt
  bool in_contact{false};           ///< a kill: the tool is in the bone
  std::vector<WallPause> pauses{};  ///< in their order
  bool ends_life{false};            ///< cell and guard end after this episode

  /// "controller killed in contact, loss 1.2 %"
  std::string text{};
};

/// Seconds of an ordinary episode's reaming.
inline constexpr double kWallReaming_s = 20.0;

/// Seconds that hand and tool need at least for a reaming.
inline constexpr double kMinWallReaming_s = 5.0;

inline constexpr std::size_t kToolsOfPlan = 4;  ///< each makes one pass

/// The episode with an index in a soak of this seed: a function of its arguments alone. Five episodes share a
/// cell, and the last of them is a kill in contact. Every fourth cell has only one episode: in turn the
/// procedure of a plan and a long reaming.
[[nodiscard]] WallEpisode WallEpisodeAt(std::uint64_t seed, int index);

/// The first episode, which is undisturbed, of a soak of this length [s]. A soak that is shorter than an
/// ordinary episode has only this one, as long as the soak, but at least kMinWallReaming_s.
[[nodiscard]] WallEpisode FirstWallEpisode(std::uint64_t seed, double soak_s);

}  // namespace osteon::studies
