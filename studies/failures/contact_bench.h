#pragma once

#include <functional>
#include <vector>

#include "studies/failures/cutting/single_contact.h"
#include "studies/failures/failure.h"

// Helpers of the contact scenarios, in addition to scenario_bench.h.

namespace osteon::studies {

/// Adds the balls and mass points of `from` to `to`. The materials of `to` do not change.
void Append(const simulation::Bone& from, simulation::Bone& to);

/// The same bone with one coefficient of friction throughout.
[[nodiscard]] simulation::Bone WithFriction(simulation::Bone bone, double friction);

/// A tool's pose with its apex at p and its feed straight down, turned about the apex by a rotation vector.
[[nodiscard]] Pose Down(const Vector3& p_m, const Vector3& turn = Vector3::Zero());

/// Angle between two directions [deg]; 180 if one is zero.
[[nodiscard]] double AngleDeg(const Vector3& a, const Vector3& b);

/// Penetration of the tool into the balls: the largest overlap of a pair, 0 if none overlaps.
[[nodiscard]] double DeepestOverlap(const std::vector<simulation::Ball>& balls, const simulation::Tool& tool,
                                    const Pose& X_GT);

/// The largest value; 0 if there are none.
[[nodiscard]] double Largest(const std::vector<double>& values);

/// The largest change from one sample to the next.
[[nodiscard]] double LargestStep(const std::vector<double>& values);

}  // namespace osteon::studies
