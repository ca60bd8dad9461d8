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

/// An arm's model, fitted to a measured response.
struct ServoFit {
  ServoModel model{};
  Estimate bandwidth_hz{}, damping_ratio{}, dead_time_s{}, gain{}, lag_s{};
  /// Chi^2 divided by its degrees of freedom; at most 1 if the residual is only rounding.
  double chi2{0.0};
  double residual{0.0};  ///< RMS of (measured - model)
};

/// Fits bandwidth, damping, dead time and gain to the exact sampled response by weighted least squares
/// (Levenberg-Marquardt from several starts). The half width of an interval is twice the standard deviation
/// that follows from the lines' sd. It is multiplied by sqrt(chi2) if the residuals are larger than the
/// lines' sd explain.
/// @returns an error with fewer than 4 lines, or if no start converges.
[[nodiscard]] tl::expected<ServoFit, std::string> FitServo(std::span<const ResponseLine> lines,
                                                           double period_s);

/// Chi^2 of a model for lines to which it was not fitted, divided by the number of their real and imaginary
/// parts.
[[nodiscard]] double ValidationChi2(const ServoModel& model, std::span<const ResponseLine> lines,
                                    double period_s);

}  // namespace osteon::studies
