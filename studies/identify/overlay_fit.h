#pragma once

#include <span>
#include <string>

#include <tl/expected.hpp>

#include "studies/identify/servo_fit.h"

namespace osteon::studies {

/// The arm's own impedance along an axis, as a force that is laid over it meets it:
///
///     mass x'' + damping x' + stiffness x = f(t - dead time)
struct OverlayFit {
  Estimate stiffness_N_per_m{}, damping_Ns_per_m{}, mass_kg{}, dead_time_s{};
  Estimate bandwidth_hz{}, damping_ratio{}, lag_s{};  ///< the same as an arm that follows its command
  double chi2{0.0};                                   ///< divided by its degrees of freedom
  double residual{0.0};                               ///< RMS of (measured - model) / measured
  bool coupled{false};  ///< the model has another axis, which gives way with this one
};

/// Weighted least squares of the impedance. An arm's axes are coupled: a force along one also turns the tool
/// against its rotational spring. Where one axis alone fits worse than chi^2 3, a coupled one is added, as
/// two zeros over two poles; the mass is then that far above all springs.
/// @param lines  of x / (f / nominal stiffness)  @param start  a servo fitted to them
/// @returns an error with fewer than 6 lines, or if nothing converges
[[nodiscard]] tl::expected<OverlayFit, std::string> FitOverlay(std::span<const ResponseLine> lines,
                                                               const ServoFit& start, double period_s,
                                                               double nominal_N_per_m);

/// The response x / f in m/N. @param response  of x / (f / nominal stiffness)
[[nodiscard]] MeasuredResponse PerForce(MeasuredResponse response, double nominal_N_per_m);

}  // namespace osteon::studies
