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

/// The options of a command line that choose a run's procedure: `--plan`, `--session`, `--resume` and others.
struct ProcedureChoice {
  std::filesystem::path plan;     ///< the plan's YAML; empty: no procedure
  std::filesystem::path session;  ///< the session's folder: new or empty; with `resume` an existing one
  bool resume{false};
  /// The simulated operator's hand: "expert", or "novice" (UseHandOfPlan).
  std::string hand{"expert"};
  /// The mesh for which the plan was made. It replaces the cell's bone; absent: the cell's bone is used.
  std::optional<MeshChoice> mesh{};
  /// Gain of the plan's guidance, 0 … 1. If it is absent, a real person gets the plan's own gain, and a
  /// simulated hand gets 0.
  std::optional<double> guidance{};
  /// Folder of a trainee's sessions: the gain is 1, reduced by a quarter for each session that passed
  /// (GainFrom). Empty: `guidance` applies.
  std::filesystem::path gain_from{};
  /// The run is in virtual time, so no date and no clock time is written.
  bool virtual_time{false};
};

/// A procedure that is about to run: plan and session have been read, nothing has been written yet.
struct Procedure {
  config::SurgicalPlanConfig plan;
  std::string plan_text;
  SessionFile file;
  std::filesystem::path folder;
  /// The plan's first reamer: the cell is set up and its bone packed for it, even if the resumed session is
  /// already at a later reamer.
  config::ToolChoice tool;
  config::ToolChoice in_use;  ///< the reamer that the run begins with
  ToolList tools;
  std::string recording;           ///< name of the recording's file in the folder: run_1.mcap
  std::optional<MeshChoice> mesh;  ///< the chosen mesh, with the plan's cup
  std::optional<double> guidance;  ///< the chosen gain, or the gain from the sessions in gain_from
};

/// Reads plan and session. @param tool replaces the cell's tool; the plan's reamers are sizes of this tool
/// The error says why the procedure is refused: a folder is in use, or the plan is not the session's.
/// @throws config::ConfigError
[[nodiscard]] tl::expected<Procedure, std::string> OpenProcedure(
    const ProcedureChoice& choice, const std::filesystem::path& cell_yaml,
    const std::optional<config::ToolChoice>& tool);

/// Makes the session of a packed cell that has procedure.tool: loads the tools, prepares the cell for them,
/// and puts the engine into the last saved state.
/// @param[in,out] engine  in: made for the cell's tool; out: made for the tool in use
/// @param setup  must outlive the session; the tools are added to its configuration for the recording
/// @param simulated  a scripted operator reams, and the buttons are pressed by a script as well
[[nodiscard]] tl::expected<std::unique_ptr<ProcedureSession>, std::string> MakeSession(
    const Procedure& procedure, const ProcedureChoice& choice, const std::filesystem::path& cell_yaml,
    const std::filesystem::path& gains, const EngineChoice& engine_choice, bool simulated, bool virtual_time,
    CellSetup& setup, std::unique_ptr<simulation::CuttingEngine>& engine);

/// Returns the height of the bone's site over the plan's centre, along the plan's axis [m].
[[nodiscard]] double RimOver(const procedure::SurgicalPlan& plan, const simulation::CutSite& site);

/// Duration of an expert's push with the last reamer, as a multiple of the duration with each other reamer
/// (assumed). The last reamer cuts with its whole head, and the expert pushes until it has reached the
/// planned depth.
inline constexpr double kExpertLastPush = 4.0;

/// Gives a simulated cell the scripted operator of a plan, from the tool `first` on. The expert follows the
/// plan. At a cup, the novice tilts the tool by 14 degrees, aims 6 mm too far superior and 5 mm too deep, and
/// presses with 140 N and an arm four times as stiff. With a burr, the novice tilts the tool by 10 degrees,
/// aims 0.8 mm to the side and 1 mm too deep, and presses with 1.5 times the script's force.
/// @param X_WG  bone in the world  @param site  of the bone, in G  @param[in,out] cell  its script and its
/// hand
void UseHandOfPlan(const procedure::SurgicalPlan& plan, const std::string& hand, const Pose& X_WG,
                   const simulation::CutSite& site, int first, config::CellConfig& cell);
/// Returns the index of the plan's reamer that is the cell's tool; 0 if the cell has another tool.
[[nodiscard]] int ReamerOf(const procedure::SurgicalPlan& plan, const config::CellConfig& cell);

/// Computes the gain of the guidance after a trainee's sessions of a plan: 1, reduced by a quarter for each
/// session that passed, but not below 0. A session passed if its assess.json says so (`osteon assess
/// --pass-at`).
/// @param folder  contains the sessions' folders, or folders in which a session is named `session`
/// The error says what the folder lacks.
[[nodiscard]] tl::expected<double, std::string> GainFrom(const std::filesystem::path& folder,
                                                         const std::string& plan_checksum);

/// Checks that a folder can hold a new session. @returns the reason if not; else empty
[[nodiscard]] std::string ValidateNewSession(const std::filesystem::path& folder);

}  // namespace osteon::session
