#pragma once

#include <memory>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/fidelity/carved_shape.h"
#include "simulation/solids/solid.h"
#include "simulation/tools/tool.h"

namespace osteon::studies {

/// The names that `--method` accepts: ours (Vulkan), brute (the same engine without culling), cpu (one thread
/// of the processor), reference (double precision), the methods of comparison (simulation/methods/method.h),
/// and PlainVoxelNames().
[[nodiscard]] const std::vector<std::string>& MethodNames();
/// "voxel-128", "voxel-256", "voxel-512": the method "voxel" with that number of voxels along the longest
/// side of the solid's box.
[[nodiscard]] const std::vector<std::string>& PlainVoxelNames();
/// Whether the method works on this project's packings and carved states. Such a method can continue the
/// carving of another such method.
[[nodiscard]] bool SharesState(const std::string& method);
/// Whether the method works on disjoint packings, as the paper's does.
[[nodiscard]] bool WantsDisjoint(const std::string& method);
/// Whether the method works on voxels of the solid: its bone needs no balls.
[[nodiscard]] bool WantsVoxels(const std::string& method);

/// The method of an engine to make, and its options.
struct MethodChoice {
  std::string method{"ours"};
  std::string device{};     ///< part of a Vulkan device's name
  double voxel_m{0.25e-3};  ///< edge of a voxel, and spacing of the tool's points; not for PlainVoxelNames()
  bool time_passes{false};  ///< measure the passes or stages of a frame
};

/// Makes an engine by its method's name, with the bone's frame G in W.
/// @param solid  solid that a voxel method fills; for PlainVoxelNames(), its box determines the voxel's edge.
///   Used only in this call
/// @returns an error that names the method and says why it can't be made.
[[nodiscard]] tl::expected<std::unique_ptr<simulation::CuttingEngine>, std::string> MakeMethodEngine(
    const simulation::Bone& bone, const simulation::Solid* solid, const simulation::Tool& tool,
    const simulation::CuttingParams& cutting, const MethodChoice& choice);

/// Returns the remaining bone in the representation of the engine's method.
[[nodiscard]] std::unique_ptr<simulation::CarvedShape> ShapeOf(const simulation::CuttingEngine& engine);

/// Number of spheres or voxels at the start; if balls were split, the present number of spheres.
[[nodiscard]] std::size_t ElementsOf(const simulation::CuttingEngine& engine, const simulation::Bone& bone);

}  // namespace osteon::studies
