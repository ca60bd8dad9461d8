#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::studies {

/// One sample of an excited run along one axis. Samples follow each other by the period of the arm; a message
/// that did not come has a sample that was not seen.
struct ExcitedSample {
  bool seen{false};  ///< the message came: y and f are known
  /// Commanded offset, as it arrived: held while answers are lost. With an overlay its force over the
  /// stiffness that the arm is thought to have.
  double u_m{0.0};
  double y_m{0.0};      ///< measured offset
  double f_N{0.0};      ///< force sensor along the axis, its tool side
  bool counted{false};  ///< in a counted period
  int draw{0}, period{0};
};

/// Samples of one axis at one speed.
struct ExcitedRun {
  double period_s{0.001};
  std::vector<ExcitedSample> samples{};
};

/// One line of a response.
struct ResponseLine {
  double hz{0.0};
  std::complex<double> value{};
  double noise_sd{0.0};        ///< from period to period: of the mean, real and imaginary part each
  double sd{0.0};              ///< the larger of noise_sd and what differs from draw to draw
  double coherence{1.0};       ///< of a single period, by noise alone, 0 … 1
  double draw_coherence{1.0};  ///< of a single draw, with what differs from draw to draw, 0 … 1
};

/// A response from one signal of a run to another.
struct MeasuredResponse {
  std::vector<ResponseLine> lines;
  int draws{0}, periods{0};  ///< periods in all
  /// Level of the output on lines without excitation up to 20 Hz, relative to the excited lines beside them:
  /// odd harmonics (friction and other symmetric nonlinearity) and even ones (backlash to one side, and
  /// noise).
  double odd_ratio{0.0}, even_ratio{0.0};
};

/// A larger share of motion on odd lines without excitation says that friction is felt.
inline constexpr double kNotLinear = 0.01;

/// The signals of a sample.
enum class Signal : std::uint8_t { kCommand, kPosition, kForce };

/// Computes the response `output` / `input` at the lines of control::Multisine, from complete counted
/// periods:
///
///     each period   least squares of a constant and all lines, over the samples that were seen; before that the
///                   drift of the output is removed by a line through the means of whole periods
///     each draw     H_d = sum Y conj(U) / sum |U|^2;   noise from Y - H_d U
///     all draws     H = mean of H_d;   what differs beyond the noise is nonlinearity
///
/// A line through the samples themselves would take power from the lowest lines; a mean over whole periods
/// does not. Variances are smoothed over five lines.
/// @returns an error that says what is missing: fewer than 2 draws with 2 periods each
[[nodiscard]] tl::expected<MeasuredResponse, std::string> MeasureResponse(const ExcitedRun& run, Signal input,
                                                                          Signal output);

/// The same lines in each counted period alone, in their order: for what changes over time.
/// @param whole  the response of the run, whose noise is that of each period times sqrt(periods)
[[nodiscard]] std::vector<std::vector<ResponseLine>> MeasurePeriods(const ExcitedRun& run, Signal input,
                                                                    Signal output,
                                                                    const MeasuredResponse& whole);

}  // namespace osteon::studies
