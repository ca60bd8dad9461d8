#pragma once

#include "studies/failures/failure.h"

namespace osteon::hil {

/// 20, energy. A burr touches, cuts a dimple and retracts, a hundred times in rows, at 4 000 rpm in a bone
/// with the cutting energy of sawbones (a third of cortical bone's). Metric: |W_drive + W_feed - W_cut| /
/// W_cut, with the drive's work (torque × angle), the feed's work (force × travel of the hand), and the
/// cutting energy of the cleared points W_cut = Σ u_c dV. Baseline: the paper as printed (its equation 5, at
/// once). Bound: 5 %. Ours passes only if, in addition, no closed cycle gives energy to the hand: neither
/// these cycles, nor loops with the spindle off. Work is summed by the trapezoidal rule; the tolerance is a
/// thousandth of the largest energy that the spring held.
///
/// The rate law charges a shallow cut for more bone than it meets (its engaged area is that of a layer) and
/// pays the difference back over 0.1 s of cutting (cutting_debt_J, negative). About half a joule is
/// outstanding at any time and counts against ours here; the many cuts make its share small.
[[nodiscard]] FailureResult RunEnergy(const FailureSetting& setting);

}  // namespace osteon::hil
