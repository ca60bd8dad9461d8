#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "simulation/bone/bone.h"
#include "simulation/fidelity/workloads.h"

namespace osteon::studies {

/// One method at one fineness. Lengths are stated for a reamer of 25 mm. For a tool of radius R they are
/// scaled by sqrt(R / 25 mm), since a smaller tool needs finer bone (the spacings of the scenes scale
/// similarly: acetabulum 1.5 mm, molar 0.3 mm).
///
/// | method              | `length_m` is                                                       |
/// |---------------------|---------------------------------------------------------------------|
/// | cpu, ours, stamps   | the lattice's spacing a, radii up to max(1.2 a, min(2 a, R / 5))    |
/// | cpu-split, split    | the lattice's spacing a, radii up to 0.9 a: balls split when touched |
/// | paper               | the greatest radius of a disjoint packing, the least is a third of it |
/// | voxel, pointshell   | a voxel's edge, and the spacing of the tool's points                |
struct MethodStep {
  std::string method;
  double length_m{0.0};
};

/// Lists every method at several finenesses, coarse to fine. @param quick  fewer of them
[[nodiscard]] std::vector<MethodStep> MethodLadder(bool quick);

/// The names of the ladder's methods.
[[nodiscard]] const std::vector<std::string>& LadderMethods();

/// Whether a method of the ladder is one of our engines: "cpu" and "ours" (on Vulkan), with splitting or
/// without.
[[nodiscard]] bool IsOurs(const std::string& method);

/// Returns the engine for a step (MethodNames()): "cpu-split" is "cpu" with other parameters, and "split" is
/// "ours" with other parameters.
[[nodiscard]] std::string EngineOfStep(const MethodStep& step);

/// Returns the workload's cutting parameters, with splitting switched on if the step's method splits balls.
[[nodiscard]] simulation::CuttingParams CuttingForStep(const MethodStep& step,
                                                       const simulation::CutWorkload& work);

/// Scales a step's length, stated for a reamer of 25 mm, to the radius of the workload's tool.
[[nodiscard]] double ScaledLength(double length_m, const simulation::CutWorkload& work);

/// A workload's bone in the form that a method needs: balls or voxels.
struct LadderBone {
  simulation::Bone bone;
  double r_max_m{0.0};  ///< largest radius of its balls; for voxels half the edge
};

/// Packs a bone for a step; its mass points are `points`, the same for every method.
/// @throws std::invalid_argument if the packing's parameters are invalid.
[[nodiscard]] LadderBone PackForStep(const MethodStep& step, const simulation::CutWorkload& work,
                                     const std::vector<simulation::MassPoint>& points, std::uint64_t seed);

/// Whether PackForStep makes the same balls for both steps, so that one packing serves both.
[[nodiscard]] bool SharePacking(const MethodStep& a, const MethodStep& b);

/// Returns a workload's mass points, 0.75 mm apart for a reamer, scaled like the steps.
[[nodiscard]] std::vector<simulation::MassPoint> LadderPoints(const simulation::CutWorkload& work);

}  // namespace osteon::studies
