#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "config/reading/load.h"
#include "config/reading/sections/read_compliance.h"
#include "session/setup/engine_choice.h"
#include "simulation/fidelity/accuracy.h"
#include "simulation/fidelity/arm_level.h"
#include "simulation/fidelity/frame_cost.h"
#include "simulation/fidelity/packing_level.h"
#include "simulation/fidelity/scene_workload.h"

namespace osteon::session {

/// A scene to plan for, or a mesh in its place, with the tool and arm that work on it.
struct PlanChoice {
  std::string scene;         ///< YAML file, or a name under scenes/; a mesh file (.stl, .obj, .ply)
  std::string mesh_scene{};  ///< the scene that a mesh replaces; empty: the acetabulum's
  std::optional<simulation::CutSite> site{};  ///< of a mesh, in its frame
  std::optional<double> scale{};              ///< of a mesh: millimetres per unit of the file
  /// The file of the cell with tool, coupling and arm; empty: cells/SCENE.yaml, or else cells/demo.yaml.
  std::filesystem::path cell;
  std::optional<config::ToolChoice> tool{};  ///< replaces the cell's tool
  std::filesystem::path config_root;
};

/// A cut to plan for: the bone, the tool that cuts it, and the arm.
struct PlanScene {
  std::string name, cell_name;
  std::vector<simulation::Material> materials;
  std::vector<simulation::MassPoint> points;
  simulation::CutWorkload work;  ///< the cut, with the cell's tool as it is in its file
  simulation::CutShape cut;
  double zone_depth_m{0.0};  ///< depth below the scene's zone that the cut reaches
  simulation::ArmFigures arm;
  double max_turn_rad_per_s{0.0};
  std::array<config::CompliancePart, 3> gives_way;  ///< the compliance of tool, layer and mount
};

/// Makes the scene to plan for from a cell's own cut of a solid.
/// @param name  of the scene  @param cell_name  of the cell's file
/// @throws std::invalid_argument if the scene's zone is neither cup nor path, or the tool cuts nothing.
[[nodiscard]] PlanScene MakePlanScene(const simulation::SceneSolid& solid,
                                      const simulation::SceneParams& scene, const config::CellConfig& cell,
                                      const std::string& cell_name);

/// Loads the scene. @returns an error that names file or option, what was found and what is accepted.
/// @throws config::ConfigError, config::ToolSizeError, std::invalid_argument
[[nodiscard]] tl::expected<PlanScene, std::string> LoadPlanScene(const PlanChoice& choice);

/// A level of fineness of a packing, with its balls.
struct PackedLevel {
  simulation::PackingLevel level;
  std::vector<simulation::Ball> balls;
};

/// The frames of an engine that carved one level along the scene's cut.
struct LevelRun {
  std::string engine, device;
  std::vector<simulation::FrameSample> frames;  ///< only frames of the cut in which the tool touched
  /// Measured after the cut, with the tool pressed off its path.
  std::vector<simulation::FeltForce> felt;
  std::vector<simulation::Ball> left;
};

/// Runs the scene's cut on one engine at several levels. The CPUs are kept awake as in a run
/// (rt::KeepCpusAwake). The levels take short turns, so that other load on the machine affects all alike. The
/// first frames of a turn do not count, since the caches still hold another level's data.
/// @param tool    replaces the scene's own
/// @param choice  which engine; one engine object is made for each level
/// @param rounds  number of times that the whole cut runs; forces and remaining balls are those of the last
/// @returns an error if an engine can't be made, a frame was refused, or Ctrl-C came.
[[nodiscard]] tl::expected<std::vector<LevelRun>, std::string> RunLevels(
    const PlanScene& scene, const std::vector<PackedLevel>& levels, const simulation::Tool& tool,
    const EngineChoice& choice, int rounds);

/// Compares a level's cut with the exact sweep of the scene's whole tool.
/// @param probe_m  radius of the ball that probes the remaining bone
[[nodiscard]] simulation::CutAccuracy MeasureLevel(const PlanScene& scene, const PackedLevel& packed,
                                                   const LevelRun& run, double probe_m);

/// Returns the mean number of balls within reach of the tool over the cut's poses in bone; the engine's
/// active balls are proportional to it.
[[nodiscard]] double BallsInReach(const PlanScene& scene, const std::vector<simulation::Ball>& balls);

}  // namespace osteon::session
