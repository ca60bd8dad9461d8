#pragma once

#include <optional>
#include <span>
#include <string>

#include <tl/expected.hpp>

#include "studies/identify/measured_response.h"
#include "studies/identify/servo_fit.h"

namespace osteon::studies {

/// A resonance between the encoders and the tool: natural frequency w_r / 2 pi and damping ratio z_r.
struct ResonanceFit {
  Estimate hz{}, damping_ratio{};
};

/// Tool and sensor, fitted to force / measured position in free air.
struct ToolForceFit {
  Estimate mass_kg{}, delay_s{};
  std::optional<ResonanceFit> resonance{};
  double chi2{0.0};  ///< divided by its degrees of freedom
};

/// Weighted least squares of the tool's inertial force,
///
///     F / x = m w^2 exp(-i w delay) R(w),   R = 1 or w_r^2 / (w_r^2 - w^2 + 2 i z_r w_r w)
///
/// A resonance is added if chi^2 without it is above 3 and falls to less than a third with it.
/// @returns an error with fewer than 4 lines, or if no force is visible: a mass of at most 3 standard
/// deviations
[[nodiscard]] tl::expected<ToolForceFit, std::string> FitToolForce(std::span<const ResponseLine> lines);

/// How a hand is fitted.
struct HandFitOptions {
  double max_hz{30.0};  ///< highest frequency of the lines that count
  /// Least standard deviation of a line, as a share of its size: no hand is exactly a spring, a damper and a
  /// mass, and no handle moves exactly as the encoders say.
  double accuracy{0.01};
  std::optional<double> delay_s{};  ///< delay of the sensor, if known; none: it is fitted
};

/// A hand that holds the handle.
struct HandFit {
  Estimate stiffness_N_per_m{}, damping_Ns_per_m{}, mass_kg{};
  Estimate grip_time_s{};  ///< time constant with which the hand's mass follows the handle; 0: at once
  Estimate delay_s{};      ///< of the force sensor
  double chi2{0.0};        ///< divided by its degrees of freedom
  double residual{0.0};    ///< RMS of (measured - fitted response), divided by the RMS of the measured one
};

/// Weighted least squares of a hand whose mass is coupled to the handle by its grip, up to a frequency:
///
///     F / x = -(k + i w b - w^2 m / (1 + i w grip_time)) exp(-i w delay)
///
/// The grip's time is fitted if chi^2 falls to less than half with it; otherwise it is 0.
/// @param tool_mass_kg  mass on the sensor's tool side, whose inertial force is removed
[[nodiscard]] tl::expected<HandFit, std::string> FitHand(std::span<const ResponseLine> lines,
                                                         double tool_mass_kg,
                                                         const HandFitOptions& options = {});

}  // namespace osteon::studies
