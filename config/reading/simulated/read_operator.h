#pragma once

#include "config/reading/strict/reader.h"
#include "hil/operator/operator_hand.h"

namespace osteon::config {

/// Reads a section `operator`: the hand, and optionally `incidents`, a list of events beside its script:
///
///     incidents:
///       - {kind: grip_step, at_s: 3, until_s: 5, stiffness_N_per_m: 6000, damping_Ns_per_m: 60,
///          stiffness_Nm_per_rad: 60, damping_Nms_per_rad: 0.8, return_ms: 300}
///       - {kind: clamp, …}              # the same keys
///       - {kind: startled_release, at_s: 7, jerk_N: 40, jerk_ms: 50, jerk_axis: [0, 0, 1], release_ms: 30,
///          away_ms: 200, return_ms: 300}
///
/// Without until_s or away_ms, an incident never ends. jerk_axis is in the site's frame (+z out of the bone).
/// hil/operator/operator_incidents.h describes the effects. If there are incidents, this function also
/// refuses missing and unknown keys of the section.
/// @throws ConfigError, also if an incident begins before the previous one in the list is over, ends before
///   it begins, or jerks with more than max_force_N.
void ReadOperator(Reader section, hil::OperatorHandParams& hand);

}  // namespace osteon::config
