#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 20, energy: a burr touches, cuts a dimple and retracts, a hundred times along rows, at 4000 rpm,
/// in a bone with the cutting energy of sawbones (a third of cortical bone's). Metric:
///
///     |W_drive + W_feed - W_cut| / W_cut
///
/// with the drive's work W_drive (torque × angle), the feed's work W_feed (force × travel of the hand), and
/// the cutting energy of the cleared points W_cut = Σ u_c dV. Baseline: the cutting paper as printed
/// (equation 5, immediate removal). Bound: 5 %.
///
/// In addition, our engine passes only if no closed cycle gives energy to the hand, with the spindle on or
/// off. Work is summed by the trapezoidal rule; the tolerance is a thousandth of the spring's largest energy.
///
/// The rate law measures the engaged area in a layer of finite depth. For a cut shallower than the layer it
/// spends more energy than the cleared bone needs, and recovers the difference within 0.1 s of cutting
/// (cutting_debt_J is negative meanwhile). At any time about half a joule is not yet recovered and counts as
/// imbalance here. Its share is small because there are many cuts.
[[nodiscard]] FailureResult RunEnergy(const FailureSetting& setting);

}  // namespace osteon::studies
