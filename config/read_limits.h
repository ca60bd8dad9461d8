#pragma once

#include "config/reader.h"
#include "control/servo_params.h"

namespace osteon::config {

/// The section `limits`. @param lbr the arm has a redundant elbow
void ReadLimits(Reader section, bool lbr, control::ServoParams& servo);

/// The cell's list `zones`, which need not be there: convex sets that apex, flange or elbow keep in or out
/// of.
void ReadZones(Reader& cell, safety::WorkspaceParams& workspace);

/// The cell's section `depth_limit`, which need not be there.
void ReadDepthLimit(Reader& cell, safety::DepthLimitParams& depth);

}  // namespace osteon::config
