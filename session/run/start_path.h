#pragma once

#include <string>

#include "session/setup/cell_setup.h"

namespace osteon::session {

/// Checks the path that an arm would take to the cell's start: tool, flange, wrist and elbow against the bone
/// and against the workspace's plane, taken as the table. Takes up to some seconds.
/// @param q_from  the arm's present position [rad]; of six axes the first six
/// @returns a text for the user that names the obstacle; empty if the path is free or not needed.
[[nodiscard]] std::string ValidateStartPath(const CellSetup& setup, const kinematics::JointVector& q_from);

}  // namespace osteon::session
