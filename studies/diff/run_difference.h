#pragma once

#include <string>
#include <vector>

#include "report/page.h"
#include "studies/diff/run_figures.h"

namespace osteon::studies {

/// One figure, with its values in both runs.
struct FigureDifference {
  RunFigure first, second;
  double difference{0.0};  ///< second less first
  double accepted{0.0};    ///< largest absolute difference at which the two values count as the same
  [[nodiscard]] bool differs() const;
};

/// A file of the configuration that is not the same in both runs.
struct ConfigDifference {
  std::string file;
  std::string first, second;  ///< the first line that differs; empty: that run lacks the line or the file
  int line{0};                ///< its number, from 1
};

/// Two runs compared.
struct RunDifference {
  /// "good": no figure differs. "look": a figure or response differs, a fault or result is in one run only,
  /// or a recording has no proper end. "bad": the second run has a fault that the first has not. Differences
  /// of the configuration are listed but not judged.
  report::ReportVerdict verdict;
  /// Whether every tick is equal to the bit, apart from the times that the machine took.
  bool identical{false};
  std::vector<FigureDifference> figures;
  /// Names of the faults that only the first run has, and that only the second run has.
  std::vector<std::string> only_first, only_second;
  std::vector<ConfigDifference> config;
  std::vector<std::string> session;           ///< other differences (version, engine, …), one line each
  std::vector<ResponseDifference> responses;  ///< of two recordings of `osteon identify`; otherwise empty
};

/// Says why two recordings cannot be compared: only one is of `osteon identify`, or the two are of different
/// kinds of run. Empty if they can be compared.
[[nodiscard]] std::string NotComparable(const RunFigures& first, const RunFigures& second);

/// @param within  two values of a figure count as the same if they differ by at most this share of its size,
/// 0 … 1
[[nodiscard]] RunDifference CompareRuns(const RunFigures& first, const RunFigures& second, double within);

}  // namespace osteon::studies
