#pragma once

#include <string>

#include "app/cell_setup.h"

namespace osteon::app {

/// Looks along the way that an arm would take to the cell's start: tool, flange, wrist and elbow against the
/// bone and the workspace's plane, which is taken for the table. Takes up to some seconds.
/// @param q_from  where the arm stands [rad]; of six axes the first six
/// @returns what is in the way, for the user; empty where the way is free or the arm is there already.
[[nodiscard]] std::string WhyNotToStart(const CellSetup& setup, const kinematics::JointVector& q_from);

}  // namespace osteon::app
