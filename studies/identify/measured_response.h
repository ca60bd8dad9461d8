#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::studies {

/// One sample of an excited run along one axis. There is one sample per period of the arm; for a message that
/// did not come, `seen` is false.
struct ExcitedSample {
  bool seen{false};  ///< the message came: y and f are known
  /// Commanded offset that the arm had: while answers are lost, the last one that arrived. With an overlay,
  /// the force divided by the arm's nominal stiffness.
  double u_m{0.0};
  double y_m{0.0};      ///< measured offset
  double f_N{0.0};      ///< force that the sensor measures along the axis
  bool counted{false};  ///< the sample lies in a period that is used for the response
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
  /// Standard deviation by noise of the mean's real and of its imaginary part, from period to period.
  double noise_sd{0.0};
  /// The larger of noise_sd and the standard deviation by the differences of the draws.
  double sd{0.0};
  double coherence{1.0};       ///< coherence of a single period, by noise alone, 0 … 1
  double draw_coherence{1.0};  ///< coherence of a single draw, including the draws' differences, 0 … 1
};

/// A response from one signal of a run to another.
struct MeasuredResponse {
  std::vector<ResponseLine> lines;
  int draws{0}, periods{0};  ///< number of draws, and number of periods of all draws
  /// Level of the output on lines without excitation up to 20 Hz, relative to the excited lines beside them.
  /// Odd harmonics show friction and other symmetric nonlinearity; even ones show one-sided backlash, and
  /// noise.
  double odd_ratio{0.0}, even_ratio{0.0};
};

/// If odd_ratio is larger, the arm is not linear: friction has an effect.
inline constexpr double kNotLinear = 0.01;

/// The signals of a sample.
enum class Signal : std::uint8_t { kCommand, kPosition, kForce };

/// Computes the response `output` / `input` at the lines of control::Multisine, from complete counted
/// periods:
///
///     each period   least squares of a constant and all lines, over the samples that were seen; before that
///                   the drift of the output is removed by a line through the means of whole periods
///     each draw     H_d = sum Y conj(U) / sum |U|^2;   noise from Y - H_d U
///     all draws     H = mean of H_d;   differences of H_d beyond the noise are nonlinearity
///
/// with the amplitudes U of the input and Y of the output. A line through the samples themselves would take
/// power from the lowest lines; a line through the means of whole periods does not. Variances are smoothed
/// over five lines.
/// @returns an error that says what is missing: fewer than 2 draws with 2 periods each
[[nodiscard]] tl::expected<MeasuredResponse, std::string> MeasureResponse(const ExcitedRun& run, Signal input,
                                                                          Signal output);

/// Measures the same lines in each counted period alone, in the order of time, to show changes over time.
/// @param whole  the response of the run; the noise of one period is that of `whole` times sqrt(periods)
[[nodiscard]] std::vector<std::vector<ResponseLine>> MeasurePeriods(const ExcitedRun& run, Signal input,
                                                                    Signal output,
                                                                    const MeasuredResponse& whole);

}  // namespace osteon::studies
