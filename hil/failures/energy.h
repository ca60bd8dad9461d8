#pragma once

#include "hil/failures/failure.h"

namespace osteon::hil {

/// 20, energy. A burr touches, cuts a dimple and retracts, a hundred times in rows, at 4 000 rpm in a bone of
/// the cutting energy of sawbones (a third of cortical bone's). Metric: how far the drive's work (torque ×
/// angle) and the feed's (force × way of the hand) together are from the cutting energy of the cleared
/// points, Σ u_c dV, over the latter. Baseline: the paper as printed (its equation 5, at once). Bound: 5 %.
/// Ours passes if, besides, no closed cycle gives energy to the hand: neither those, nor loops with the
/// spindle off. The trapezoidal rule over samples counts; what it may err by is a thousandth of the most
/// energy that the spring held.
///
/// The rate law charges a shallow cut for more bone than it meets (its engaged area is that of a layer) and
/// pays the difference back over .1 s of cutting (cutting_debt_J, negative): about half a joule that is
/// outstanding at any time counts against ours here, and is why so many cuts are asked for.
[[nodiscard]] FailureResult RunEnergy(const FailureSetting& setting);

}  // namespace osteon::hil
