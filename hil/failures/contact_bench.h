#pragma once

#include <functional>
#include <vector>

#include "hil/failures/failure.h"
#include "hil/failures/single_contact.h"

// What the contact scenarios share beyond scenario_bench.h.

namespace osteon::hil {

/// Balls and mass points of `from` added to those of `to`; the materials are to's.
void Append(const simulation::Bone& from, simulation::Bone& to);

/// The bone with one coefficient of friction throughout.
[[nodiscard]] simulation::Bone WithFriction(simulation::Bone bone, double friction);

/// Feed straight down, then turned by a rotation vector; apex at p.
[[nodiscard]] Pose Down(const Vector3& p_m, const Vector3& turn = Vector3::Zero());

/// Angle between two directions [deg]; 180 where one is zero.
[[nodiscard]] double AngleDeg(const Vector3& a, const Vector3& b);

/// How deep the tool lies in the balls: the greatest overlap of a pair, 0 where none overlaps.
[[nodiscard]] double DeepestOverlap(const std::vector<simulation::Ball>& balls, const simulation::Tool& tool,
                                    const Pose& X_GT);

/// The largest value; 0 of none.
[[nodiscard]] double Largest(const std::vector<double>& values);

/// The largest change from one sample to the next.
[[nodiscard]] double LargestStep(const std::vector<double>& values);

}  // namespace osteon::hil
