#pragma once

#include <complex>
#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "io/recording/messages.h"
#include "studies/diff/run_figure.h"

namespace osteon::studies {

/// A measured response at its lines.
struct RecordedResponse {
  std::string by;  ///< "encoders", "force" or "hand"
  struct Line {
    double hz{0.0};
    std::complex<double> value{};
    double sd{0.0};  ///< of real and imaginary part each
  };
  std::vector<Line> lines;
};

/// A recording of `osteon identify` has these beside its ticks: the excitation, and what identify finds by
/// it.
struct ExcitedFigures {
  std::string kind;        ///< "a free run along an axis": runs of different kinds have nothing to compare
  std::string excitation;  ///< axis or joint, speed, seed, draws and periods, as the event has them
  std::vector<RunFigure> figures{};
  std::vector<RecordedResponse> responses{};
  std::string refused{};  ///< why nothing was found; empty: something was
};

/// Whether an event's text is that of an excitation.
[[nodiscard]] bool IsExcitation(const std::string& event);

/// Estimates a recording of `osteon identify` as `osteon identify --recording` does.
/// @param event  the excitation's, as IsExcitation accepts it
[[nodiscard]] ExcitedFigures ReadExcitedFigures(const std::filesystem::path& recording,
                                                const io::SessionInfo& session, const std::string& event);

/// A line of a response that both runs have.
struct LineDifference {
  RecordedResponse::Line first, second;
  double accepted{0.0};  ///< |first - second| up to which the line is the same
  [[nodiscard]] bool differs() const { return !(std::abs(first.value - second.value) <= accepted); }
};
struct ResponseDifference {
  std::string by;
  std::vector<LineDifference> lines;
  [[nodiscard]] std::size_t differing() const;
  /// The line that differs most, by what is accepted. @pre there are lines
  [[nodiscard]] const LineDifference& worst() const;
};

/// Compares responses line by line: the same within a share of their size, or two standard deviations of the
/// difference. @param only  what only one of them has, a line each, is added
[[nodiscard]] std::vector<ResponseDifference> CompareResponses(const ExcitedFigures& first,
                                                               const ExcitedFigures& second, double within,
                                                               std::vector<std::string>& only);

}  // namespace osteon::studies
