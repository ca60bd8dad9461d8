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

/// The command line's choice of what to plan for: a scene, or a mesh in place of its solid, with tool and
/// arm.
struct PlanChoice {
  std::string scene;         ///< YAML file, or a name under scenes/; a mesh file (.stl, .obj, .ply)
  std::string mesh_scene{};  ///< the scene whose solid a mesh replaces; empty: the acetabulum
  std::optional<simulation::CutSite> site{};  ///< cut site of a mesh, in the mesh's frame
  std::optional<double> scale{};              ///< for a mesh: millimetres per unit of the file
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
  simulation::CutWorkload work;  ///< the cut, with the cell's tool as in its file
  simulation::CutShape cut;
  double zone_depth_m{0.0};  ///< largest depth below the scene's zone that the cut reaches
  simulation::ArmFigures arm;
  double max_turn_rad_per_s{0.0};
  std::array<config::CompliancePart, 3> gives_way;  ///< compliance of tool, tissue layer and mount
};

/// Makes the scene to plan for from a cell's own cut of a solid.
/// @param name  name of the scene  @param cell_name  name of the cell's file
/// @throws std::invalid_argument if the scene's zone is neither a cup nor a path, or if the tool cannot cut.
[[nodiscard]] PlanScene MakePlanScene(const simulation::SceneSolid& solid,
                                      const simulation::SceneParams& scene, const config::CellConfig& cell,
                                      const std::string& cell_name);

/// Loads the scene. @returns the scene, or an error that names file or option, what was found and what is
/// accepted.
/// @throws config::ConfigError, config::ToolSizeError, std::invalid_argument
[[nodiscard]] tl::expected<PlanScene, std::string> LoadPlanScene(const PlanChoice& choice);

/// A level of fineness of a packing, with its balls.
struct PackedLevel {
  simulation::PackingLevel level;
  std::vector<simulation::Ball> balls;
};

/// The timed frames of one engine that carved one level along the scene's cut.
struct LevelRun {
  std::string engine, device;
  /// frames of the cut in which the tool touched bone, without those at the start of a turn
  std::vector<simulation::FrameSample> frames;
  /// Forces measured after the cut, with the tool pressed against the bone beside its path.
  std::vector<simulation::FeltForce> felt;
  std::vector<simulation::Ball> left;
};

/// Runs the scene's cut on one engine at several levels. The CPUs are kept awake as in a run
/// (rt::KeepCpusAwake). The levels are run in short turns, so that other load on the machine affects all of
/// them equally. The first frames of a turn are not counted, because the caches still contain another level's
/// data.
/// @param tool    replaces the scene's own
/// @param choice  the kind of engine; one engine object is made for each level
/// @param rounds  number of runs of the whole cut; forces and remaining balls are those of the last run
/// @returns the levels' runs, or an error if an engine can't be made, if a frame was refused, or after
/// Ctrl-C.
[[nodiscard]] tl::expected<std::vector<LevelRun>, std::string> RunLevels(
    const PlanScene& scene, const std::vector<PackedLevel>& levels, const simulation::Tool& tool,
    const EngineChoice& choice, int rounds);

/// Compares a level's cut with the exact sweep of the scene's whole tool.
/// @param probe_m  radius of the ball that probes the remaining bone
[[nodiscard]] simulation::CutAccuracy MeasureLevel(const PlanScene& scene, const PackedLevel& packed,
                                                   const LevelRun& run, double probe_m);

/// Returns the number of balls within reach of the tool, averaged over poses of the cut. The number of the
/// engine's active balls is proportional to it.
[[nodiscard]] double BallsInReach(const PlanScene& scene, const std::vector<simulation::Ball>& balls);

}  // namespace osteon::session
