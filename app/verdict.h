#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

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

/// The level, and a row for each reason: the first rows of a table.
[[nodiscard]] std::vector<SummaryRow> VerdictRows(const Verdict& verdict);

/// VerdictRows on stdout, keys `key_width` wide; a level that is not good stands out on a terminal that shows
/// colours (unless NO_COLOR is set).
void PrintVerdict(const Verdict& verdict, int key_width);

/// A command's result as a JSON file's text: `verdict: {level, reasons}` first, then the fields of `result`.
[[nodiscard]] std::string ResultText(const Verdict& verdict, const nlohmann::ordered_json& result);

/// Judges a run by its figures: how it ended, its faults, how long a limit or an old model kept force from
/// the hand, what was lost of the recording.
[[nodiscard]] Verdict JudgeRun(const RunSummary& summary);

}  // namespace osteon::app
