#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "config/load.h"
#include "simulation/fidelity/arm_level.h"
#include "simulation/fidelity/frame_cost.h"
#include "simulation/fidelity/packing_level.h"
#include "simulation/metrics/accuracy.h"
#include "simulation/metrics/scene_workload.h"

namespace osteon::app {

/// A scene to plan for, or a mesh in the place of one, and a tool and an arm that work on it.
struct PlanChoice {
  std::string scene;         ///< YAML file, or a name under scenes/; a mesh file (.stl, .obj, .ply)
  std::string mesh_scene{};  ///< whose place a mesh takes; empty: the acetabulum's
  std::optional<simulation::Cup> site{};  ///< of a mesh, in its frame
  std::optional<double> scale{};          ///< of a mesh: millimetres to one of its units
  std::filesystem::path cell;  ///< tool, coupling and arm; empty: cells/SCENE.yaml, or else cells/demo.yaml
  std::optional<config::ToolChoice> tool{};  ///< instead of the cell's
  std::filesystem::path config_root;
};

struct PlanScene {
  std::string name, cell_name;
  std::vector<simulation::Material> materials;
  std::vector<simulation::MassPoint> points;
  simulation::CutWorkload work;  ///< with the cell's tool as it is
  simulation::CutShape cut;
  double zone_depth_m{0.0};
  simulation::ArmFigures arm;
  double max_turn_rad_per_s{0.0};
};

/// A cell's own cut of a solid.
/// @param name  of the scene  @param cell_name  of the cell's file
/// @throws std::invalid_argument where the scene's zone is neither cup nor path, or the tool cuts nothing.
[[nodiscard]] PlanScene MakePlanScene(const simulation::SceneSolid& solid,
                                      const simulation::SceneParams& scene, const config::CellConfig& cell,
                                      const std::string& cell_name);

/// @returns an error that names file or option, what was found and what is accepted.
/// @throws config::ConfigError, config::ToolSizeError, std::invalid_argument
[[nodiscard]] tl::expected<PlanScene, std::string> LoadPlanScene(const PlanChoice& choice);

/// A fineness with its balls.
struct PackedLevel {
  simulation::PackingLevel level;
  std::vector<simulation::Ball> balls;
};

/// One fineness, carved by an engine as the scene is cut.
struct LevelRun {
  std::string device;
  std::vector<simulation::FrameSample> frames;  ///< those of the cut in which the tool touched
  std::vector<simulation::FeltForce> felt;      ///< pressed off its way afterwards
  std::vector<simulation::Ball> left;
};

/// Runs the scene's cut on Vulkan, at several finenesses, with the CPUs awake as a run has them
/// (rt::KeepCpusAwake), some frames of each in turn, so that what else the machine does falls on all alike;
/// the first of a turn, which find another engine's work in the caches, do not count as samples.
/// @param tool    instead of the scene's own
/// @param device  part of a Vulkan device's name
/// @param rounds  the whole cut so many times; forces and what is left are the last one's
/// @returns an error where there is no such device, a frame was refused, or Ctrl-C came.
[[nodiscard]] tl::expected<std::vector<LevelRun>, std::string> RunLevels(
    const PlanScene& scene, const std::vector<PackedLevel>& levels, const simulation::Tool& tool,
    const std::string& device, int rounds);

/// A level's cut against the exact sweep of the scene's whole tool.
/// @param probe_m  radius of the ball that feels what is left
[[nodiscard]] simulation::CutAccuracy MeasureLevel(const PlanScene& scene, const PackedLevel& packed,
                                                   const LevelRun& run, double probe_m);

/// Balls that are within reach of the tool, in the mean over the cut's poses in bone: in proportion to what
/// the engine works on.
[[nodiscard]] double BallsInReach(const PlanScene& scene, const std::vector<simulation::Ball>& balls);

}  // namespace osteon::app
