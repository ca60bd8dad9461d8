#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "config/reading/load.h"
#include "config/reading/load_surgical_plan.h"
#include "session/procedure/procedure_session.h"
#include "session/procedure/session_file.h"
#include "session/setup/cell_setup.h"
#include "session/setup/engine_choice.h"

namespace osteon::session {

/// The procedure that a run was asked for: `--plan`, `--session`, `--resume`.
struct ProcedureChoice {
  std::filesystem::path plan;     ///< the plan's YAML; empty: no procedure
  std::filesystem::path session;  ///< folder: a new or empty one, or with `resume` a session's
  bool resume{false};
  /// The simulated operator's hand: "expert", or "novice" (UseHandOfPlan).
  std::string hand{"expert"};
  /// The mesh that the plan is for and that takes the place of the cell's bone; absent: the cell has the
  /// bone.
  std::optional<MeshChoice> mesh{};
  /// Gain of the plan's guidance, 0 … 1; absent: the plan's own with a person's hand, 0 with a simulated one.
  std::optional<double> guidance{};
  /// A trainee's sessions: the gain is 1, and a quarter less for each that passed. Empty: `guidance` counts.
  std::filesystem::path gain_from{};
  /// The run is one in virtual time, which writes nothing that the clock says.
  bool virtual_time{false};
};

/// A procedure that is about to run: plan and session are read, nothing is written yet.
struct Procedure {
  config::SurgicalPlanConfig plan;
  std::string plan_text;
  SessionFile file;
  std::filesystem::path folder;
  /// The plan's first reamer: the cell is set up and its bone packed with it, however far the session is.
  config::ToolChoice tool;
  config::ToolChoice in_use;  ///< the reamer that the run begins with
  ToolList tools;
  std::string recording;           ///< name in the folder: run_1.mcap
  std::optional<MeshChoice> mesh;  ///< as chosen, with the plan's cup
  std::optional<double> guidance;  ///< as chosen, or by the sessions of gain_from
};

/// Reads plan and session. @param tool  replaces the cell's: of its sizes are the plan's reamers
/// @returns why the procedure is refused: a folder in use, another plan than the session's
/// @throws config::ConfigError
[[nodiscard]] tl::expected<Procedure, std::string> OpenProcedure(
    const ProcedureChoice& choice, const std::filesystem::path& cell_yaml,
    const std::optional<config::ToolChoice>& tool);

/// Makes the session of a packed cell that has procedure.tool: loads the tools, prepares the cell for
/// them, and puts the engine into the last saved state.
/// @param[in,out] engine  of the cell's tool; of the one in use afterwards
/// @param setup  outlives the session; its configuration for the recording gets the tools
/// @param simulated  a scripted operator reams, whose buttons are pressed as well
[[nodiscard]] tl::expected<std::unique_ptr<ProcedureSession>, std::string> MakeSession(
    const Procedure& procedure, const ProcedureChoice& choice, const std::filesystem::path& cell_yaml,
    const std::filesystem::path& gains, const EngineChoice& engine_choice, bool simulated, bool virtual_time,
    CellSetup& setup, std::unique_ptr<simulation::CuttingEngine>& engine);

/// Height of the bone's site over the plan's centre, along the plan's axis [m].
[[nodiscard]] double RimOver(const procedure::SurgicalPlan& plan, const simulation::CutSite& site);

/// An expert dwells with the last reamer, whose whole head cuts, until it is at the plan (assumed): its push
/// is this many times as long as that of each other one.
inline constexpr double kExpertLastPush = 4.0;

/// Gives a simulated cell the scripted operator of a plan, from the tool `first` on: the expert keeps to it.
/// The novice at a cup is 14 degrees tilted, aims 6 mm aside toward superior and 5 mm too deep, and presses
/// with 140 N and an arm four times as stiff; with a burr 10 degrees, 0.8 mm, 1 mm, and half again the force.
/// @param X_WG  bone in the world  @param site  of the bone, in G  @param[in,out] cell  its script and its
/// hand
void UseHandOfPlan(const procedure::SurgicalPlan& plan, const std::string& hand, const Pose& X_WG,
                   const simulation::CutSite& site, int first, config::CellConfig& cell);
/// The reamer of a plan that a cell has; the first one if it has another tool.
[[nodiscard]] int ReamerOf(const procedure::SurgicalPlan& plan, const config::CellConfig& cell);

/// The gain of the guidance after a trainee's sessions of a plan: 1, and a quarter less for each that passed,
/// not below 0. A session passed if its assess.json says so (`osteon assess --pass-at`).
/// @param folder  has the sessions' folders, or folders that have them as `session`
/// The error says what the folder lacks.
[[nodiscard]] tl::expected<double, std::string> GainFrom(const std::filesystem::path& folder,
                                                         const std::string& plan_checksum);

/// Whether a folder can hold a new session; the reason if not.
[[nodiscard]] std::string ValidateNewSession(const std::filesystem::path& folder);

}  // namespace osteon::session
