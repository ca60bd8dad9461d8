#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace osteon::studies {

/// The events that may happen in an episode of a soak in wall time.
enum class WallEvent : std::uint8_t {
  kReaming,         ///< none: only the reaming
  kPause,           ///< pauses that an operator requests, and their ends
  kPages,           ///< pages of the console disconnect and connect again all the time
  kHaltedCell,      ///< the cell's process is halted for some milliseconds; the loop recovers
  kTools,           ///< the procedure of a plan with its four reamers, each taken in a pause
  kLong,            ///< a long reaming, with a pause in each quarter
  kControllerKill,  ///< SIGKILL to `osteon run`
  kGuardKill,       ///< SIGKILL to `osteon guard`
  kEngineKill,      ///< SIGKILL to `osteon simulate`, the engine in its own process
  kCellKill,        ///< SIGKILL to `osteon cell`: arm, sensor, drive and PLC fall silent
};
inline constexpr int kWallEvents = 10;
[[nodiscard]] std::string_view NameOf(WallEvent event);
[[nodiscard]] bool IsKill(WallEvent event);

/// A cell's process and its guard, which run through several episodes.
struct CellLife {
  int index{0};
  double loss_ratio{0.0};      ///< share of the arm's datagrams that are lost, in each direction
  bool engine_process{false};  ///< the engine is a process of its own
  bool plan{false};            ///< the operator's hand follows the plan
  double seconds{0.0};         ///< duration of the operator's script
};

/// A pause. Its begin is measured in the time of rendering.
struct WallPause {
  double begin_s{0.0}, length_s{0.0};
  bool next_tool{false};  ///< the plan's next tool is mounted during the pause
};

/// One episode of a soak in wall time.
struct WallEpisode {
  int index{0};
  CellLife life;
  WallEvent event{WallEvent::kReaming};
  double seconds{0.0};              ///< time of rendering
  double at_s{0.0};                 ///< time of rendering after which a kill or a halt takes place
  double halt_s{0.0};               ///< duration of a halt
  bool in_contact{false};           ///< for a kill: the tool is in the bone
  std::vector<WallPause> pauses{};  ///< in the order of time
  bool ends_life{false};            ///< cell and guard end after this episode

  /// "controller killed in contact, loss 1.2 %"
  std::string text{};
};

/// Seconds of an ordinary episode's reaming.
inline constexpr double kWallReaming_s = 20.0;

/// Shortest reaming that hand and tool can do, in seconds.
inline constexpr double kMinWallReaming_s = 5.0;

inline constexpr std::size_t kToolsOfPlan = 4;  ///< number of the plan's tools; each makes one pass

/// The episode with an index in a soak of this seed; it depends only on the two arguments. Five episodes
/// share a cell, and the last of them is a kill in contact. Every fourth cell has only one episode:
/// alternately the procedure of a plan, and a long reaming.
[[nodiscard]] WallEpisode WallEpisodeAt(std::uint64_t seed, int index);

/// The first episode of a soak; it is undisturbed. If the soak is shorter than an ordinary episode, this is
/// the only episode, and it is as long as the soak, but at least kMinWallReaming_s. @param soak_s  length of
/// the soak
[[nodiscard]] WallEpisode FirstWallEpisode(std::uint64_t seed, double soak_s);

}  // namespace osteon::studies
