#pragma once

#include <span>
#include <string>

#include <tl/expected.hpp>

#include "studies/identify/servo_fit.h"

namespace osteon::app {

/// The arm's own impedance along an axis, as a force that is laid over it meets it:
///
///     mass x'' + damping x' + stiffness x = f(t - dead time)
struct OverlayFit {
  Estimate stiffness_N_per_m{}, damping_Ns_per_m{}, mass_kg{}, dead_time_s{};
  Estimate bandwidth_hz{}, damping_ratio{}, lag_s{};  ///< the same as an arm that follows its command
  double chi2{0.0};       ///< divided by its degrees of freedom, of the lines that were used
  double residual{0.0};   ///< RMS of (measured - model) / measured, of the lines that were used
  bool ends_only{false};  ///< only the two lowest lines and those from 15 Hz on were used
};

/// Weighted least squares of the impedance. An arm's axes are coupled: around the frequencies of its springs
/// one axis alone is not of second order. Where all lines together fit worse than chi^2 3, those from 15 Hz
/// on, where mass and dead time decide, and the two lowest, where the spring does, are fitted alone.
/// @param lines  of x / (f / nominal stiffness)  @param start  a servo fitted to them
/// @returns an error with fewer than 6 lines, or if nothing converges
[[nodiscard]] tl::expected<OverlayFit, std::string> FitOverlay(std::span<const ResponseLine> lines,
                                                               const ServoFit& start, double period_s,
                                                               double nominal_N_per_m);

/// The response x / f in m/N. @param response  of x / (f / nominal stiffness)
[[nodiscard]] MeasuredResponse PerForce(MeasuredResponse response, double nominal_N_per_m);

}  // namespace osteon::app
