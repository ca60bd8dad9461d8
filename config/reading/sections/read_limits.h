#pragma once

#include "config/reading/strict/reader.h"
#include "control/setup/servo_params.h"

namespace osteon::config {

/// Whether the positions in a section are in the bone's frame (`frame: bone`) instead of the world's.
[[nodiscard]] bool IsInBoneFrame(Reader& section);
/// Reads the section `limits`. @param lbr the arm has a redundant elbow
void ReadLimits(Reader section, bool lbr, control::ServoParams& servo);

/// Checks `on_force_limit` and `max_tool_in_bone_mm` against law and coupling. Call after these are read.
/// Sets the defaults: the reaction is `slow` with the admittance law and `yield` with the impedance law; the
/// largest depth of the tool in bone is twice the depth at which the force limit is reached, plus 3 mm.
void CompleteForceLimit(Reader limits, control::ServoParams& servo);

/// Reads the cell's optional list `zones`: convex sets that apex, flange or elbow must stay in or out of.
void ReadZones(Reader& cell, const Pose& X_WG, safety::WorkspaceParams& workspace);

/// Reads the cell's optional section `depth_limit`.
void ReadDepthLimit(Reader& cell, const Pose& X_WG, safety::DepthLimitParams& depth);
/// Checks the values of `depth_limit` against each other. Call after Finish().
/// @param coupling_N_per_m  the coupling's stiffness in the cell's file; gains that lower it also lower the
///   depth limit's stiffness
void CheckDepthLimit(Reader cell, const safety::DepthLimitParams& depth, double coupling_N_per_m);

}  // namespace osteon::config
