#include "studies/soak/soak_script.h"

#include <fmt/format.h>

#include "studies/soak/seeded_draws.h"

namespace osteon::studies {
namespace {

// Converts a drawn number 0 … 23 to a kind. 8 of the 24 numbers mean reaming, 4 each loss, pause and
// recovery, and 1 each of the four parts that fall silent.
EpisodeKind KindOf(int drawn) {
  if (drawn < 8) return EpisodeKind::kReaming;
  if (drawn < 12) return EpisodeKind::kLoss;
  if (drawn < 16) return EpisodeKind::kPause;
  if (drawn < 20) return EpisodeKind::kRecovery;
  return static_cast<EpisodeKind>(static_cast<int>(EpisodeKind::kSensorSilent) + drawn - 20);
}

// The override of the cell's file that silences one direction of a connection for a time.
std::string SilenceOverride(const char* wire, const char* direction, double from_s, double to_s) {
  return fmt::format("injections=[{{wire: {}, direction: {}, from_s: {}, to_s: {}, silence: true}}]", wire,
                     direction, from_s, to_s);
}

// Draws the times of the kind's faults or pause, and adds the faults or the pause to the episode.
void AddFaults(Episode& episode, SeededDraws& draws) {
  constexpr double kForEver_s = 80000.0;  // a time after the end of every episode
  const double at_s = draws.Between(2.0, 0.6 * episode.seconds);
  switch (episode.kind) {
    case EpisodeKind::kLoss:
      // The cell stops if five messages in a row are lost. This hardly ever happens with these loss ratios.
      episode.set.push_back(
          fmt::format("injections=[{{wire: arm, direction: both, from_s: 0.5, to_s: {}, loss_ratio: {}, "
                      "burst_count: 3}}, {{wire: arm, direction: to_controller, from_s: {}, to_s: {}, "
                      "jitter_ms: 1}}]",
                      episode.seconds, draws.Between(0.005, 0.02), at_s, at_s + 2.0));
      break;
    case EpisodeKind::kRecovery:
      episode.set.emplace_back("link_quality.ask_again=true");
      episode.set.push_back(SilenceOverride("arm", "both", at_s, at_s + 0.06));
      break;
    case EpisodeKind::kPause:
      episode.pause_s = at_s;
      episode.resume_s = at_s + draws.Between(0.5, 3.0);
      break;
    case EpisodeKind::kSensorSilent:
      episode.set.push_back(SilenceOverride("force_sensor", "to_controller", at_s, kForEver_s));
      break;
    case EpisodeKind::kDriveSilent:
      episode.set.push_back(SilenceOverride("drive", "to_controller", at_s, kForEver_s));
      break;
    case EpisodeKind::kPlcSilent:
      episode.set.push_back(SilenceOverride("plc", "both", at_s, kForEver_s));
      break;
    case EpisodeKind::kArmSilent:
      episode.set.push_back(SilenceOverride("arm", "to_controller", at_s, kForEver_s));
      break;
    case EpisodeKind::kReference:
    case EpisodeKind::kReaming:
      break;
  }
}

}  // namespace

std::string_view NameOf(EpisodeKind kind) {
  switch (kind) {
    case EpisodeKind::kReference:
      return "reference";
    case EpisodeKind::kReaming:
      return "reaming";
    case EpisodeKind::kLoss:
      return "loss";
    case EpisodeKind::kPause:
      return "pause";
    case EpisodeKind::kRecovery:
      return "recovery";
    case EpisodeKind::kSensorSilent:
      return "sensor silent";
    case EpisodeKind::kDriveSilent:
      return "drive silent";
    case EpisodeKind::kPlcSilent:
      return "PLC silent";
    case EpisodeKind::kArmSilent:
      return "arm silent";
  }
  return "unknown";
}

std::string_view InjectedFault(EpisodeKind kind) {
  switch (kind) {
    case EpisodeKind::kSensorSilent:
      return "force sensor stale";
    case EpisodeKind::kDriveSilent:
      return "spindle drive fault";
    case EpisodeKind::kPlcSilent:
      return "motion not permitted";
    case EpisodeKind::kArmSilent:
    case EpisodeKind::kRecovery:
      return "arm message stale";
    default:
      return "";
  }
}

bool EndsWithFault(EpisodeKind kind) {
  return !InjectedFault(kind).empty() && kind != EpisodeKind::kRecovery;
}

Episode EpisodeAt(std::uint64_t seed, int index) {
  Episode episode{.index = index};
  if (index % kEpisodesPerReference == 0) {
    episode.seconds = kReference_s;
    episode.text = fmt::format("reference, {:g} s", kReference_s);
    return episode;
  }
  SeededDraws draws(seed, index);
  episode.kind = KindOf(draws.Index(24));
  episode.seconds = draws.Between(8.0, 40.0);
  const int diameter_mm = 49 + draws.Index(4);
  episode.set = {fmt::format("tool_diameter_mm={}", diameter_mm),
                 fmt::format("operator.tremor_N={}", draws.Between(0.0, 2.0)),
                 fmt::format("operator.tremor_seed={}", 1 + draws.Index(1000)),
                 fmt::format("script.push_force_N={}", draws.Between(60.0, 120.0))};
  AddFaults(episode, draws);
  episode.text =
      fmt::format("{}, reamer of {} mm, {:.1f} s", NameOf(episode.kind), diameter_mm, episode.seconds);
  return episode;
}

}  // namespace osteon::studies
