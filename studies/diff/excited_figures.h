#pragma once

#include <complex>
#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "io/recording/messages.h"
#include "studies/diff/run_figure.h"

namespace osteon::studies {

/// A measured frequency response, at the frequencies ("lines") of its excitation.
struct RecordedResponse {
  std::string by;  ///< the signal that it was measured by: "encoders", "force" or "hand"
  struct Line {
    double hz{0.0};
    std::complex<double> value{};
    double sd{0.0};  ///< standard deviation of the real and of the imaginary part
  };
  std::vector<Line> lines;
};

/// The data of a recording of `osteon identify` in addition to its ticks: the excitation, and the results
/// that identify estimates from the recording.
struct ExcitedFigures {
  std::string kind;  ///< "a free run along an axis": runs of different kinds have nothing to compare
  /// Axis or joint, speed, seed, draws and periods, as the recorded event states them.
  std::string excitation;
  std::vector<RunFigure> figures{};
  std::vector<RecordedResponse> responses{};
  /// Why the recording, or the first part that was refused, was not estimated; empty: all was estimated.
  std::string refused{};
};

/// Whether an event's text is that by which `osteon identify` marks its excitation in a recording.
[[nodiscard]] bool IsExcitation(const std::string& event);

/// Estimates a recording of `osteon identify`, in the same way as `osteon identify --recording`.
/// @param event  text of the event that marks the excitation, as IsExcitation accepts it
[[nodiscard]] ExcitedFigures ReadExcitedFigures(const std::filesystem::path& recording,
                                                const io::SessionInfo& session, const std::string& event);

/// One frequency of a response that both runs have, with the two values.
struct LineDifference {
  RecordedResponse::Line first, second;
  double accepted{0.0};  ///< largest |first - second| with which the line counts as the same
  [[nodiscard]] bool differs() const { return !(std::abs(first.value - second.value) <= accepted); }
};
/// A response that both runs have, compared frequency by frequency.
struct ResponseDifference {
  std::string by;  ///< name of the signal by which the response was measured, as in RecordedResponse
  std::vector<LineDifference> lines;
  [[nodiscard]] std::size_t differing() const;
  /// The line whose difference is the largest multiple of the accepted one. @pre there are lines
  [[nodiscard]] const LineDifference& worst() const;
};

/// Compares the responses of two runs line by line, each line with that of the same frequency. Two lines
/// count as the same if they differ by at most the share `within` of their size, or by at most two standard
/// deviations of the difference.
/// @param only  receives a text for each response that only one of the runs has, and for each response with
/// lines at frequencies that only one of the runs has
[[nodiscard]] std::vector<ResponseDifference> CompareResponses(const ExcitedFigures& first,
                                                               const ExcitedFigures& second, double within,
                                                               std::vector<std::string>& only);

}  // namespace osteon::studies
