#pragma once

#include <memory>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "simulation/bone.h"
#include "simulation/cutting_engine.h"
#include "simulation/metrics/carved_shape.h"
#include "simulation/solids/solid.h"
#include "simulation/tool.h"

namespace osteon::app {

/// What `--method` takes: ours (Vulkan), brute (the same engine without culling), reference (double
/// precision), and the methods that they are compared with (simulation/methods/method.h).
[[nodiscard]] const std::vector<std::string>& MethodNames();
/// Of our packings and their state: one can begin from what another of them has carved.
[[nodiscard]] bool SharesState(const std::string& method);
/// Works on disjoint packings, as the paper does.
[[nodiscard]] bool WantsDisjoint(const std::string& method);
/// Works on voxels of the solid: its bone needs no balls.
[[nodiscard]] bool WantsVoxels(const std::string& method);

struct MethodChoice {
  std::string method{"ours"};
  std::string device{};     ///< part of a Vulkan device's name
  double voxel_m{0.25e-3};  ///< edge of a voxel, and distance of the tool's points
  bool time_passes{false};  ///< Vulkan: timestamps between the passes
};

/// An engine by its method's name, with the bone's frame G in W.
/// @param solid  what a voxel method fills; only read here
/// @returns an error naming the method, and why it can't be made.
[[nodiscard]] tl::expected<std::unique_ptr<simulation::CuttingEngine>, std::string> MakeMethodEngine(
    const simulation::Bone& bone, const simulation::Solid* solid, const simulation::Tool& tool,
    const simulation::CuttingParams& cutting, const MethodChoice& choice);

/// The bone that is left, as the engine's method knows it.
[[nodiscard]] std::unique_ptr<simulation::CarvedShape> ShapeOf(const simulation::CuttingEngine& engine);

/// Spheres, or voxels, that it began with; or spheres that it has now, where splitting has made more of them.
[[nodiscard]] std::size_t ElementsOf(const simulation::CuttingEngine& engine, const simulation::Bone& bone);

}  // namespace osteon::app
