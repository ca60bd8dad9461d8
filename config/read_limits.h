#pragma once

#include "config/reader.h"
#include "control/servo_params.h"

namespace osteon::config {

/// The section `limits`. @param lbr the arm has a redundant elbow
void ReadLimits(Reader section, bool lbr, control::ServoParams& servo);

/// What the section says of a coupling at its force limit, against the law and the coupling, once these are
/// known; and what holds where it says nothing: `slow` with the admittance law, `yield` with the impedance
/// law, and twice the way at which the force limit is reached and 3 mm for the tool's depth in bone.
void CompleteForceLimit(Reader limits, control::ServoParams& servo);

/// The cell's list `zones`, which need not be there: convex sets that apex, flange or elbow keep in or out
/// of.
void ReadZones(Reader& cell, safety::WorkspaceParams& workspace);

/// The cell's section `depth_limit`, which need not be there.
void ReadDepthLimit(Reader& cell, safety::DepthLimitParams& depth);
/// One value of it against another, once all are known to be there. @param coupling_N_per_m the coupling's
/// own stiffness; gains that lower it lower the depth limit's along with it
void CheckDepthLimit(Reader cell, const safety::DepthLimitParams& depth, double coupling_N_per_m);

}  // namespace osteon::config
