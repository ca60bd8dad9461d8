#pragma once

#include <string>

#include "session/setup/cell_setup.h"

namespace osteon::session {

/// Checks the path that an arm would take to the cell's start: tests tool, flange, wrist and elbow against
/// the bone and against the workspace's plane, which is taken as the table. Takes up to some seconds.
/// @param q_from  the arm's present position [rad]; a six-axis arm uses the first six
/// @returns a text for the user that names the obstacle; empty if the path is free or not needed.
[[nodiscard]] std::string ValidateStartPath(const CellSetup& setup, const kinematics::JointVector& q_from);

/// Checks the straight path in joint space between any two positions in the same way, whatever its length.
/// @param q_from, q_to  [rad]; a six-axis arm uses the first six
/// @returns a text that names the obstacle; empty if the path is free
[[nodiscard]] std::string ValidatePath(const CellSetup& setup, const kinematics::JointVector& q_from,
                                       const kinematics::JointVector& q_to);

}  // namespace osteon::session
