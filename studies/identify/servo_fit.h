#pragma once

#include <array>
#include <span>
#include <string>

#include <tl/expected.hpp>

#include "studies/identify/measured_response.h"
#include "studies/identify/servo_response.h"

namespace osteon::studies {

/// A value with the half width of its 95 % interval.
struct Estimate {
  double value{0.0}, half_width{0.0};
};

/// An arm fitted to a measured response.
struct ServoFit {
  ServoModel model{};
  Estimate bandwidth_hz{}, damping_ratio{}, dead_time_s{}, gain{}, lag_s{};
  double chi2{0.0};      ///< divided by its degrees of freedom; at most 1 where only rounding is left
  double residual{0.0};  ///< RMS of measured - model
};

/// Weighted least squares of bandwidth, damping, dead time and gain, with the exact sampled response; by
/// Levenberg-Marquardt from several starts. Intervals are twice the standard deviation, which follows from
/// the lines' sd, and is multiplied by sqrt(chi2) if the model fits worse than the lines' sd explain.
/// @returns an error with fewer than 4 lines, or if no start converges.
[[nodiscard]] tl::expected<ServoFit, std::string> FitServo(std::span<const ResponseLine> lines,
                                                           double period_s);

/// Chi^2 of a model against lines that it was not fitted to, divided by their number (real and imaginary
/// parts).
[[nodiscard]] double ValidationChi2(const ServoModel& model, std::span<const ResponseLine> lines,
                                    double period_s);

}  // namespace osteon::studies
