#include "studies/bench/method_engine.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <fmt/format.h>

#include "session/setup/engine_choice.h"
#include "simulation/methods/method.h"
#include "simulation/removal/cut_metrics.h"

namespace osteon::studies {
namespace {

// Voxels along the longest side, in the order of PlainVoxelNames().
constexpr std::array kPlainVoxels{128, 256, 512};

// Number of voxels along the longest side, by a name of PlainVoxelNames(); 0 for every other name.
int PlainVoxelsOf(const std::string& method) {
  for (std::size_t i = 0; i < kPlainVoxels.size(); ++i)
    if (PlainVoxelNames()[i] == method) return kPlainVoxels[i];
  return 0;
}

}  // namespace

const std::vector<std::string>& PlainVoxelNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const int count : kPlainVoxels) all.push_back(fmt::format("voxel-{}", count));
    return all;
  }();
  return names;
}

const std::vector<std::string>& MethodNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all{"ours", "brute", "cpu", "reference"};
    for (const simulation::Method method : simulation::kMethods) all.emplace_back(MethodName(method));
    all.insert(all.end(), PlainVoxelNames().begin(), PlainVoxelNames().end());
    return all;
  }();
  return names;
}

bool SharesState(const std::string& method) {
  return method == "ours" || method == "brute" || method == "cpu" || method == "reference";
}

bool WantsDisjoint(const std::string& method) { return method == "paper" || method == "paper-printed"; }

bool WantsVoxels(const std::string& method) {
  return method == "voxel" || method == "pointshell" || PlainVoxelsOf(method) > 0;
}

tl::expected<std::unique_ptr<simulation::CuttingEngine>, std::string> MakeMethodEngine(
    const simulation::Bone& bone, const simulation::Solid* solid, const simulation::Tool& tool,
    const simulation::CuttingParams& cutting, const MethodChoice& choice) {
  const Pose X_WG = Pose::Identity();
  if (const int count = PlainVoxelsOf(choice.method); count > 0) {
    if (solid == nullptr)
      return tl::unexpected(choice.method + ": found a bone without a solid, accepted one with");
    MethodChoice voxels = choice;
    voxels.method = simulation::MethodName(simulation::Method::kVoxelProxy);
    voxels.voxel_m = solid->Bounds().sizes().maxCoeff() / count;
    return MakeMethodEngine(bone, solid, tool, cutting, voxels);
  }
  try {
    for (const simulation::Method method : simulation::kMethods)
      if (choice.method == MethodName(method))
        return simulation::MakeMethod(method, bone, solid, tool, X_WG, cutting,
                                      {.voxel_m = choice.voxel_m, .point_spacing_m = choice.voxel_m});
  } catch (const std::invalid_argument& error) {
    return tl::unexpected(choice.method + ": " + error.what());
  }
  const bool is_vulkan = choice.method == "ours" || choice.method == "brute";
  auto engine = session::MakeEngine(
      {.engine = is_vulkan ? "vulkan" : choice.method, .device = choice.device}, bone, tool, X_WG, cutting,
      {.time_passes = choice.time_passes, .brute_force = choice.method == "brute"});
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

}  // namespace osteon::studies
