#include "studies/bench/method_engine.h"

#include <algorithm>
#include <stdexcept>

#include "session/setup/engine_choice.h"
#include "simulation/methods/method.h"
#include "simulation/removal/cut_metrics.h"

namespace osteon::app {

const std::vector<std::string>& MethodNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all{"ours", "brute", "cpu", "reference"};
    for (const simulation::Method method : simulation::kMethods) all.emplace_back(MethodName(method));
    return all;
  }();
  return names;
}

bool SharesState(const std::string& method) {
  return method == "ours" || method == "brute" || method == "cpu" || method == "reference";
}

bool WantsDisjoint(const std::string& method) { return method == "paper" || method == "paper-printed"; }

bool WantsVoxels(const std::string& method) { return method == "voxel" || method == "pointshell"; }

tl::expected<std::unique_ptr<simulation::CuttingEngine>, std::string> MakeMethodEngine(
    const simulation::Bone& bone, const simulation::Solid* solid, const simulation::Tool& tool,
    const simulation::CuttingParams& cutting, const MethodChoice& choice) {
  const Pose X_WG = Pose::Identity();
  try {
    for (const simulation::Method method : simulation::kMethods)
      if (choice.method == MethodName(method))
        return simulation::MakeMethod(method, bone, solid, tool, X_WG, cutting,
                                      {.voxel_m = choice.voxel_m, .point_spacing_m = choice.voxel_m});
  } catch (const std::invalid_argument& error) {
    return tl::unexpected(choice.method + ": " + error.what());
  }
  const bool is_vulkan = choice.method == "ours" || choice.method == "brute";
  auto engine =
      MakeEngine({.engine = is_vulkan ? "vulkan" : choice.method, .device = choice.device}, bone, tool, X_WG,
                 cutting, {.time_passes = choice.time_passes, .brute_force = choice.method == "brute"});
  if (!engine && !is_vulkan) return tl::unexpected(choice.method + ": " + engine.error());
  return engine;
}

std::unique_ptr<simulation::CarvedShape> ShapeOf(const simulation::CuttingEngine& engine) {
  if (const auto* method = dynamic_cast<const simulation::MethodEngine*>(&engine)) return method->Shape();
  return std::make_unique<simulation::BallUnion>(simulation::LiveBalls(engine.Snapshot()));
}

std::size_t ElementsOf(const simulation::CuttingEngine& engine, const simulation::Bone& bone) {
  if (const auto* method = dynamic_cast<const simulation::MethodEngine*>(&engine))
    return method->ElementCount();
  return std::max(bone.balls.size(), simulation::LiveBalls(engine.Snapshot()).size());
}

}  // namespace osteon::app
