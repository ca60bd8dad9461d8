#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "simulation/bone.h"
#include "simulation/metrics/workloads.h"

namespace osteon::app {

/// One method at one fineness. Lengths are those for a reamer of 25 mm; for a tool of radius R they are
/// scaled by sqrt(R / 25 mm), since a smaller tool asks for finer bone (the scenes do about the same:
/// acetabulum 1.5 mm, molar .3 mm).
///
/// | method              | `length_m` is                                                       |
/// |---------------------|---------------------------------------------------------------------|
/// | ours, stamps        | the lattice's spacing a, radii up to max(1.2 a, min(2 a, R / 5))    |
/// | split               | the lattice's spacing a, radii up to .9 a: ours, balls split when touched |
/// | paper               | the greatest radius of a disjoint packing, the least a third of it  |
/// | voxel, pointshell   | a voxel's edge, and the distance of the tool's points               |
struct MethodStep {
  std::string method;
  double length_m{0.0};
};

/// Every method at several finenesses, coarse to fine. @param quick  fewer of them
[[nodiscard]] std::vector<MethodStep> MethodLadder(bool quick);

/// The ladder's methods by name.
[[nodiscard]] const std::vector<std::string>& LadderMethods();

/// What makes a step's engine (MethodNames()): "split" is ours with other parameters.
[[nodiscard]] std::string EngineOfStep(const MethodStep& step);

/// A workload's parameters, with a step's splitting.
[[nodiscard]] simulation::CuttingParams CuttingForStep(const MethodStep& step,
                                                       const simulation::CutWorkload& work);

/// How a length of a step becomes one of a workload.
[[nodiscard]] double ScaledLength(double length_m, const simulation::CutWorkload& work);

/// What a method is given of a workload's bone.
struct LadderBone {
  simulation::Bone bone;
  double r_max_m{0.0};  ///< of its balls; of voxels half the edge
};

/// Packs a bone for a step; mass points are those of `points`, the same for every method.
/// @throws std::invalid_argument as the packings do.
[[nodiscard]] LadderBone PackForStep(const MethodStep& step, const simulation::CutWorkload& work,
                                     const std::vector<simulation::MassPoint>& points, std::uint64_t seed);

/// Whether PackForStep makes the same balls of both steps: what was packed for one serves the other.
[[nodiscard]] bool SharePacking(const MethodStep& a, const MethodStep& b);

/// The mass points of a workload, .75 mm apart at a reamer, scaled as the steps are.
[[nodiscard]] std::vector<simulation::MassPoint> LadderPoints(const simulation::CutWorkload& work);

}  // namespace osteon::app
