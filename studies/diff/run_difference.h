#pragma once

#include <string>
#include <vector>

#include "report/page.h"
#include "studies/diff/run_figures.h"

namespace osteon::studies {

/// A figure of both runs.
struct FigureDifference {
  RunFigure first, second;
  double difference{0.0};  ///< second less first
  double accepted{0.0};    ///< a larger difference, either way, counts
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
  /// good: no figure differs; look: a figure or response differs, a fault or result is in one run only, or a
  /// recording has no proper end; bad: the second run has a fault that the first has not. A different
  /// configuration is only stated.
  report::ReportVerdict verdict;
  bool identical{false};  ///< every tick is equal to the bit, except for the times that the machine took
  std::vector<FigureDifference> figures;
  std::vector<std::string> only_first, only_second;  ///< names of faults that only one of the runs has
  std::vector<ConfigDifference> config;
  std::vector<std::string> session;           ///< other differences: version, engine, …, one line each
  std::vector<ResponseDifference> responses;  ///< of two recordings of `osteon identify`
};

/// Says why two recordings cannot be compared: only one is of `osteon identify`, or the two are of different
/// kinds of run. Empty if they can.
[[nodiscard]] std::string NotComparable(const RunFigures& first, const RunFigures& second);

/// @param within  share of a figure's size, 0 … 1, up to which it counts as the same
[[nodiscard]] RunDifference CompareRuns(const RunFigures& first, const RunFigures& second, double within);

}  // namespace osteon::studies
