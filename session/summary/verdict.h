#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "report/report.h"

namespace osteon::session {

struct RunSummary;

/// The verdict on a result, for users and programs.
enum class VerdictLevel {
  kGood,     ///< nothing to criticise
  kWarning,  ///< ended as it should, but with the deficiencies named in the reasons
  kBad,      ///< a fault, no result, or a result that does not show what it should
};

/// "good", "look", "bad".
[[nodiscard]] const char* NameOf(VerdictLevel level);

/// The level of a result, and the reasons for it.
struct Verdict {
  VerdictLevel level{VerdictLevel::kGood};
  std::vector<std::string> reasons;  ///< sentences, in the order in which they were found; empty if good

  /// Raises the level to `at_least` if it is lower, and adds the reason.
  void Add(VerdictLevel at_least, std::string reason);

  [[nodiscard]] report::ReportVerdict ForReport() const {
    return {.level = NameOf(level), .reasons = reasons};
  }
};

/// Makes the rows of the level and its reasons, for the top of a table.
[[nodiscard]] std::vector<report::SummaryRow> VerdictRows(const Verdict& verdict);

/// Prints VerdictRows on stdout, keys `key_width` wide; a level other than good is coloured on a terminal
/// with colours (unless NO_COLOR is set).
void PrintVerdict(const Verdict& verdict, int key_width);

/// Makes the JSON text of a command's result: `verdict: {level, reasons}` first, then the fields of `result`.
[[nodiscard]] std::string ResultText(const Verdict& verdict, const nlohmann::ordered_json& result);

/// Judges a run by its figures: how it ended, its faults, how long limits and old models reduced the force,
/// and gaps in the recording.
[[nodiscard]] Verdict JudgeRun(const RunSummary& summary);

}  // namespace osteon::session
