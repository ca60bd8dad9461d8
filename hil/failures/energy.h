#pragma once

#include "hil/failures/failure.h"

namespace osteon::hil {

/// 20, energy. A ball touches, cuts and retracts, a hundred times, each time a little deeper. Metric: how far
/// the drive's work (torque × angle) and the feed's (force × way of the hand) together are from the cutting
/// energy of the cleared points, Σ u_c dV, over the latter. Baseline: the paper as printed (its equation 5,
/// at once). Bound: 5 %. Ours passes if, besides, no closed cycle gives energy to the hand: neither those,
/// nor loops with the spindle off. The trapezoidal rule over samples counts; what it may err by is a
/// thousandth of the most energy that the spring held.
[[nodiscard]] FailureResult RunEnergy(const FailureSetting& setting);

}  // namespace osteon::hil
