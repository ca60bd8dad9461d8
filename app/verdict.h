#pragma once

#include <string>
#include <vector>

#include "app/report/report.h"

namespace osteon::app {

struct RunSummary;

/// How good a result is, for a person and for a program. Never better than what happened.
enum class VerdictLevel {
  kGood,  ///< nothing to look at
  kLook,  ///< ended as it should, but something took from what was asked for: the reasons say what
  kBad,   ///< a fault, no result, or one that does not say what it is meant to
};

/// "good", "look", "bad".
[[nodiscard]] const char* NameOf(VerdictLevel level);

struct Verdict {
  VerdictLevel level{VerdictLevel::kGood};
  std::vector<std::string> reasons;  ///< sentences, in the order in which they were found; empty where good

  /// Makes the level at least as bad as this, with a reason.
  void Add(VerdictLevel at_least, std::string reason);

  [[nodiscard]] ReportVerdict ForReport() const { return {.level = NameOf(level), .reasons = reasons}; }
};

/// Judges a run by its figures: how it ended, its faults, how long a limit or an old model kept force from
/// the hand, what was lost of the recording.
[[nodiscard]] Verdict JudgeRun(const RunSummary& summary);

}  // namespace osteon::app
