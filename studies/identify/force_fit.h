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

/// Mass and delay of the tool on the sensor, fitted to force / measured position in free air.
struct ToolForceFit {
  Estimate mass_kg{}, delay_s{};
  std::optional<ResonanceFit> resonance{};
  double chi2{0.0};  ///< chi^2 divided by its degrees of freedom
};

/// Fits the tool's inertial force by weighted least squares,
///
///     F / x = m w^2 exp(-i w delay) R(w),   R = 1 or w_r^2 / (w_r^2 - w^2 + 2 i z_r w_r w)
///
/// with the force F, the measured position x, the mass m, and the resonance R between encoders and tool. A
/// resonance is added if chi^2 without it is above 3, and falls to less than a third with it.
/// @returns an error with fewer than 4 lines, or if no force stands out: the mass is at most 3 standard
/// deviations
[[nodiscard]] tl::expected<ToolForceFit, std::string> FitToolForce(std::span<const ResponseLine> lines);

/// Options of the fit of a hand.
struct HandFitOptions {
  double max_hz{30.0};  ///< highest frequency of the lines that are fitted
  /// Minimum standard deviation of a line, as a share of its size. No hand is exactly a spring, a damper and
  /// a mass, and no handle moves exactly as the encoders say.
  double accuracy{0.01};
  std::optional<double> delay_s{};  ///< delay of the force sensor, if known; none: the delay is fitted
};

/// Impedance of a hand that holds the handle.
struct HandFit {
  Estimate stiffness_N_per_m{}, damping_Ns_per_m{}, mass_kg{};
  Estimate grip_time_s{};  ///< time constant with which the hand's mass follows the handle; 0: at once
  Estimate delay_s{};      ///< delay of the force sensor
  double chi2{0.0};        ///< chi^2 divided by its degrees of freedom
  /// RMS of (measured - fitted response), divided by the RMS of the measured response.
  double residual{0.0};
};

/// Fits, by weighted least squares, a hand whose mass m is coupled to the handle by the hand's grip:
///
///     F / x = -(k + i w b - w^2 m / (1 + i w grip_time)) exp(-i w delay)
///
/// with the force F, the position x, the stiffness k and the damping b, up to HandFitOptions::max_hz. The
/// grip time is fitted if chi^2 falls to less than half with it; otherwise it is 0.
/// @param tool_mass_kg  mass on the sensor's tool side; its inertial force is removed
[[nodiscard]] tl::expected<HandFit, std::string> FitHand(std::span<const ResponseLine> lines,
                                                         double tool_mass_kg,
                                                         const HandFitOptions& options = {});

}  // namespace osteon::studies
