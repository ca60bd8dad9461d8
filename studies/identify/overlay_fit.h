#pragma once

#include "studies/identify/servo_fit.h"

namespace osteon::app {

/// The arm's own impedance along an axis, as a force that is laid over it meets it:
///
///     mass x'' + damping x' + stiffness x = f(t - dead time)
struct OverlayFit {
  Estimate stiffness_N_per_m{}, damping_Ns_per_m{}, mass_kg{}, dead_time_s{};
};

/// Computes the impedance from an arm that was fitted to x / (f / nominal stiffness). Intervals take the
/// parameters' errors for independent.
/// @param nominal_N_per_m  that the force was divided by; > 0
[[nodiscard]] OverlayFit OverlayOf(const ServoFit& fit, double nominal_N_per_m);

/// The response x / f in m/N. @param response  of x / (f / nominal stiffness)
[[nodiscard]] MeasuredResponse PerForce(MeasuredResponse response, double nominal_N_per_m);

}  // namespace osteon::app
