#pragma once

#include <optional>
#include <span>
#include <string>

#include <tl/expected.hpp>

#include "studies/identify/measured_response.h"
#include "studies/identify/servo_fit.h"

namespace osteon::studies {

/// A resonance beyond the encoders.
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
/// A resonance is added if chi^2 falls by more than kResonanceGain and the fit without it is worse than 3.
/// @returns an error with fewer than 4 lines, or where no force is seen: a mass below 3 standard deviations
[[nodiscard]] tl::expected<ToolForceFit, std::string> FitToolForce(std::span<const ResponseLine> lines);

/// A hand that holds the handle.
struct HandFit {
  Estimate stiffness_N_per_m{}, damping_Ns_per_m{}, mass_kg{}, delay_s{};
  double chi2{0.0};
};

/// Weighted least squares of a hand, F / x = -(k + i w b - w^2 m) exp(-i w delay), up to a frequency.
/// @param tool_mass_kg  on the sensor's tool side, whose inertial force is removed
[[nodiscard]] tl::expected<HandFit, std::string> FitHand(std::span<const ResponseLine> lines,
                                                         double tool_mass_kg, double max_hz = 30.0);

}  // namespace osteon::studies
