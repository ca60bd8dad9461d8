#include "studies/soak/wall_script.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "hil/operator/procedure_script.h"
#include "session/procedure/prepare_session.h"
#include "studies/soak/seeded_draws.h"

namespace osteon::studies {
namespace {

constexpr int kEpisodesPerLife = 5, kLivesPerGroup = 4;
// Number of episodes of a group: three lives of five episodes each, and one life of a single episode.
constexpr int kEpisodesPerGroup = (kLivesPerGroup - 1) * kEpisodesPerLife + 1;
// Lengths of two episodes: the procedure with the plan's four tools, and the long reaming.
constexpr double kTools_s = 120.0, kLong_s = 240.0;
// Times of a kill since rendering began: clear of bone, or in bone. The hand needs about 1 s to reach the
// bone.
constexpr double kClearOfBone_s = 0.3, kInBone_s = 4.0;

// Offset of the indices with which lives are drawn, so that lives and episodes use different random numbers.
constexpr int kLifeDraws = 1 << 20;

// Draws the life of a cell. Two of three lives lose datagrams. The last life of each group follows a plan or
// is a long reaming, alternately. The engine has a process of its own in every other of the remaining lives.
CellLife LifeAt(std::uint64_t seed, int index) {
  SeededDraws draws(seed, kLifeDraws + index);
  CellLife life{.index = index, .seconds = kWallReaming_s};
  if (index % 3 != 0) life.loss_ratio = draws.Between(0.002, 0.01);
  life.engine_process = index % 2 == 1;
  if (index % kLivesPerGroup != kLivesPerGroup - 1) return life;
  life.plan = index % (2 * kLivesPerGroup) == kLivesPerGroup - 1;
  life.engine_process = false;
  life.seconds = life.plan ? kTools_s : kLong_s;
  return life;
}

// The event of the episode with number `place` within its life. The first is an undisturbed reaming, the last
// a kill.
WallEvent EventAt(int place, const CellLife& life, SeededDraws& draws) {
  if (place == 0) return WallEvent::kReaming;
  const WallEvent kill = life.engine_process ? WallEvent::kEngineKill : WallEvent::kControllerKill;
  if (place == kEpisodesPerLife - 1)
    return std::array{WallEvent::kControllerKill, WallEvent::kGuardKill, WallEvent::kCellKill, kill}.at(
        static_cast<std::size_t>(draws.Index(4)));
  return std::array{WallEvent::kPause,          WallEvent::kPages,     WallEvent::kHaltedCell,
                    WallEvent::kControllerKill, WallEvent::kGuardKill, kill}
      .at(static_cast<std::size_t>(draws.Index(6)));
}

// Draws the times of the episode's kill, halt or pauses.
void AddTimes(WallEpisode& episode, SeededDraws& draws) {
  episode.at_s = episode.in_contact ? draws.Between(kInBone_s, episode.seconds - 6.0) : kClearOfBone_s;
  if (episode.event == WallEvent::kHaltedCell) {
    episode.at_s = draws.Between(kInBone_s, episode.seconds - 6.0);
    // Longer than the loop waits for the arm (five deadlines, 26 ms), but shorter than the drive may be
    // silent (40 ms).
    episode.halt_s = draws.Between(0.030, 0.035);
  }
  if (episode.event == WallEvent::kPause)
    episode.pauses = {{draws.Between(3.0, 6.0), draws.Between(0.5, 2.0)},
                      {draws.Between(9.0, 14.0), draws.Between(0.5, 2.0)}};
  if (episode.event == WallEvent::kTools) {
    // The script of the expert's hand holds each tool at the place where it is changed. The script continues
    // during a pause; the requests of a pause take about half a second in addition.
    const hil::HandScript script = hil::MakeProcedureScript({.seconds = episode.seconds,
                                                             .heights_m = std::vector<double>(kToolsOfPlan),
                                                             .last_push_ratio = session::kExpertLastPush});
    double paused_s = 0.0;  // the script's time that passed in pauses, in which the loop does not render
    for (const hil::ToolHold& hold : hil::HoldsForChanges(script)) {
      const double length_s = draws.Between(0.3, 1.0);
      episode.pauses.push_back({.begin_s = hold.begin_s + 0.15 * hold.length_s - paused_s,
                                .length_s = length_s,
                                .next_tool = true});
      paused_s += length_s + 0.5;
    }
  }
  if (episode.event == WallEvent::kLong)
    for (int quarter = 0; quarter < 4; ++quarter)
      episode.pauses.push_back(
          {(quarter + draws.Between(0.3, 0.8)) * episode.seconds / 4.0, draws.Between(0.5, 4.0)});
}

std::string TextOf(const WallEpisode& episode) {
  std::string text(NameOf(episode.event));
  if (IsKill(episode.event)) text += episode.in_contact ? " in contact" : " clear of bone";
  if (episode.halt_s > 0.0) text += fmt::format(" for {:.0f} ms", 1e3 * episode.halt_s);
  if (episode.life.loss_ratio > 0.0) text += fmt::format(", loss {:.1f} %", 100.0 * episode.life.loss_ratio);
  if (episode.life.engine_process) text += ", engine apart";
  return text;
}

}  // namespace

std::string_view NameOf(WallEvent event) {
  switch (event) {
    case WallEvent::kReaming:
      return "reaming";
    case WallEvent::kPause:
      return "pauses";
    case WallEvent::kPages:
      return "pages leave and come";
    case WallEvent::kHaltedCell:
      return "cell halted";
    case WallEvent::kTools:
      return "four reamers of a plan";
    case WallEvent::kLong:
      return "long reaming";
    case WallEvent::kControllerKill:
      return "controller killed";
    case WallEvent::kGuardKill:
      return "guard killed";
    case WallEvent::kEngineKill:
      return "engine killed";
    case WallEvent::kCellKill:
      return "cell killed";
  }
  return "unknown";
}

bool IsKill(WallEvent event) { return event >= WallEvent::kControllerKill; }

WallEpisode WallEpisodeAt(std::uint64_t seed, int index) {
  const int group = index / kEpisodesPerGroup, within = index % kEpisodesPerGroup;
  const int life = within / kEpisodesPerLife, place = within % kEpisodesPerLife;
  SeededDraws draws(seed, index);
  WallEpisode episode{.index = index, .life = LifeAt(seed, group * kLivesPerGroup + life)};
  episode.seconds = episode.life.seconds;
  if (life == kLivesPerGroup - 1) {
    episode.event = episode.life.plan ? WallEvent::kTools : WallEvent::kLong;
    episode.ends_life = true;
  } else {
    episode.event = EventAt(place, episode.life, draws);
    episode.ends_life = place == kEpisodesPerLife - 1;
    episode.in_contact = episode.ends_life;
  }
  AddTimes(episode, draws);
  episode.text = TextOf(episode);
  return episode;
}

WallEpisode FirstWallEpisode(std::uint64_t seed, double soak_s) {
  WallEpisode episode = WallEpisodeAt(seed, 0);
  episode.seconds = std::clamp(soak_s, kMinWallReaming_s, kWallReaming_s);
  episode.life.seconds = episode.seconds;
  return episode;
}

}  // namespace osteon::studies
