#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "config/reading/cell_config.h"
#include "config/reading/load.h"
#include "io/recording/messages.h"
#include "session/setup/engine_choice.h"
#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/solids/solid.h"

namespace osteon::session {

/// A mesh or a packing file that replaces the cell's bone.
struct MeshChoice {
  std::filesystem::path file;
  /// The site to cut, in the file's frame, after scaling; absent: a packing file may name its own site.
  std::optional<simulation::CutSite> cup{};
  double scale{1.0};  ///< millimetres per unit of the file
};

/// Parses "X,Y,Z,NX,NY,NZ,R" (mm; the axis in any length). The error names the part, what was found and what
/// is accepted.
[[nodiscard]] tl::expected<simulation::CutSite, std::string> ParseCup(const std::string& text);

struct PlannedCell;

/// A cell with everything for a run but its engine.
struct CellSetup {
  config::CellConfig config;  ///< tool and cutting as planned, if the bone was planned
  simulation::Bone bone;
  std::shared_ptr<const simulation::Solid> solid;  ///< solid from which the bone was packed; null: not known
  Pose X_WG{Pose::Identity()};                     ///< pose of the bone's frame G in the world
  std::string config_text;                         ///< the YAML files as read, one after the other
  io::ConfigSource config_source;                  ///< every file that was read, for the recording
  std::string cell_name;                           ///< name of the cell's YAML file
  std::shared_ptr<const PlannedCell> planned;      ///< null: the bone was packed as the scene says, or loaded
  std::string bone_warning;  ///< about the bone's mesh (SceneSolid::warning); empty: none
};

/// Loads the cell's YAML and the solid of its bone. The bone has no balls yet (PackAsScene, or PackCell of
/// planned_cell.h), unless they were loaded. A mesh is placed so that its site (a cup, or the circle where a
/// drill enters) lies where the site of the cell's scene would lie.
/// @param mesh_instead  replaces the cell's own `bone` or scene
/// @param tool  replaces the cell's tool  @param gains  a file that overrides the cell's gains; empty: none
/// @param identified  a file of `osteon identify` that replaces the cell's own; empty: the cell's own, if any
/// @throws config::ConfigError; config::ToolSizeError if `tool` has no such size. Errors of the mesh are
/// returned as text.
[[nodiscard]] tl::expected<CellSetup, std::string> PrepareCell(
    const std::filesystem::path& cell_yaml, const std::optional<MeshChoice>& mesh_instead,
    const std::optional<config::ToolChoice>& tool = {}, const std::filesystem::path& gains = {},
    const std::filesystem::path& identified = {});

/// Makes the cell of a recording from the recording only, except for a mesh that its configuration names. If
/// that mesh is missing, or the run had another bone than the configuration's (`demo --mesh`), solid is null
/// and bone_warning says why; the site is then the scene's. An error names the part of the configuration that
/// is missing or wrong.
[[nodiscard]] tl::expected<CellSetup, std::string> SetUpRecorded(const io::SessionInfo& session,
                                                                 const std::optional<MeshChoice>& mesh = {});

/// Packs a prepared cell's bone by the scene's own `packing`. A bone that was loaded from a packing file
/// stays as it is.
void PackAsScene(CellSetup& setup);

/// Makes the engine for the cell's bone and tool.
[[nodiscard]] tl::expected<std::unique_ptr<simulation::CuttingEngine>, std::string> MakeEngine(
    const CellSetup& setup, const EngineChoice& choice);

}  // namespace osteon::session
