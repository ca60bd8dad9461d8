#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "config/reading/load_surgical_plan.h"
#include "session/procedure/plan_guidance.h"
#include "session/procedure/procedure_session.h"
#include "session/run/cell_run.h"
#include "tests/session/set_up_cell.h"
#include "tests/temporary_path.h"

// A test fixture: a session with a plan of two reamers on the simulated cell in virtual time.

namespace osteon::session {

inline constexpr const char* kCell = OSTEON_SOURCE_DIR "/config/cells/demo.yaml";
inline constexpr const char* kTool = OSTEON_SOURCE_DIR "/config/tools/reamer.yaml";

/// Hash of a carved state as session files write it: 16 hexadecimal digits.
inline std::string HashText(const simulation::CarvedState& state) {
  return fmt::format("{:016x}", simulation::HashState(state));
}

/// The demo's cell with a reamer of this diameter; its bone is packed once for all tests of a program.
inline const CellSetup& PackedCell(double diameter_mm) {
  static std::map<double, CellSetup> packed;
  auto found = packed.find(diameter_mm);
  if (found == packed.end()) {
    auto made =
        SetUpCell(kCell, std::nullopt, config::ToolChoice{.file = kTool, .diameter_m = 1e-3 * diameter_mm});
    EXPECT_TRUE(made) << made.error();
    found = packed.emplace(diameter_mm, std::move(*made)).first;
  }
  return found->second;
}

/// The demo's cell, a plan of reamers of 48 and 50 mm, both of which cut, and a session in a folder `name`.
struct Rig {
  struct Choice {
    double seconds{1.0};                  // length of the run
    const SessionFile* resumed{nullptr};  // the session to continue; null: a new session
    bool guided{false};                   // with the guidance of the demo's plan
    bool scripted{true};                  // tools are changed by a script, not by requests
  };
  Rig(const std::string& name, double seconds, const SessionFile* resumed = nullptr)
      : Rig(name, Choice{.seconds = seconds, .resumed = resumed}) {}
  /// Sets up the cell, its tools, script and engine, and the session, but runs nothing. A resumed session
  /// begins with the tool of its last segment and records to run_2.mcap.
  Rig(const std::string& name, const Choice& choice) : folder(TemporaryPath(name)) {
    std::filesystem::create_directories(folder);
    const SessionFile* resumed = choice.resumed;
    ToolList list{.diameters_mm = {48.0, 50.0}};
    if (resumed) list.first = resumed->segments.back().tool_index;
    const double first_mm = list.diameters_mm.at(static_cast<std::size_t>(list.first));
    setup = std::make_unique<CellSetup>(PackedCell(first_mm));
    procedure::SurgicalPlan plan;
    plan.name = "two";
    for (const double height_mm : {-1.0, -2.0})  // of the apexes: the second reamer goes 1 mm deeper
      plan.tools.push_back(
          {.diameter_m = 1e-3 * list.diameters_mm[plan.tools.size()], .height_m = 1e-3 * height_mm});
    if (choice.guided) {
      plan.guidance =
          config::LoadSurgicalPlan(OSTEON_SOURCE_DIR "/config/plans/acetabulum.yaml").plan.guidance;
      for (const procedure::PlannedTool& reamer : plan.tools)
        list.guidance.push_back(*GuidanceOf(plan, reamer, setup->X_WG));
    }
    auto tools = LoadProcedureTools(setup->config, kCell, kTool, {}, list);
    PrepareForTools(tools, setup->config);
    KeepToolList(list, setup->config_source);
    hil::ProcedureScriptParams script{.X_WC = setup->X_WG, .head_radius_m = 0.5e-3 * first_mm};
    script.tool_yaw_rad = setup->config.start.tool_yaw_rad;
    script.start_height_m = setup->config.start.height_m;
    for (std::size_t i = static_cast<std::size_t>(list.first); i < plan.tools.size(); ++i)
      script.heights_m.push_back(plan.tools[i].height_m);
    setup->config.script = script;
    engine = std::move(*MakeEngine(*setup, {}));
    recording = resumed ? "run_2.mcap" : "run_1.mcap";
    planned = std::move(plan);
    tool_table = std::move(tools);
    first_tool = list.first;
    scripted = choice.scripted;
    SessionFile file;
    if (resumed) file = *resumed;
    file.diameters_mm = list.diameters_mm;
    session = MakeSession(file);
    params = {.seconds = choice.seconds,
              .virtual_time = true,
              .recording = folder / recording,
              .procedure = session.get()};
  }

  /// Makes a session of this cell that begins with `file`: new, or resumed.
  std::unique_ptr<ProcedureSession> MakeSession(const SessionFile& file) {
    return std::make_unique<ProcedureSession>(
        ProcedureParams{.folder = folder,
                        .plan = planned,
                        .file = file,
                        .tools = tool_table,
                        .tool = first_tool,
                        .recording = recording,
                        .bone = &setup->bone,
                        .solid = setup->solid.get(),
                        .events = setup->config.scene.events,
                        .X_WG = setup->X_WG,
                        .make_engine =
                            [this](const simulation::Tool& tool) {
                              return MakeEngine({}, setup->bone, tool, setup->X_WG, setup->config.cutting);
                            },
                        .scripted = scripted});
  }

  /// Runs the cell with the session; expects no error, and no fault unless `may_fault`.
  void Run() {
    const auto begun = session->Begin(*engine);
    ASSERT_TRUE(begun) << begun.error();
    const auto run = RunCell(*setup, *engine, params);
    ASSERT_TRUE(run) << run.error().what;
    result = *run;
    if (!may_fault) {
      EXPECT_FALSE(result.faults.Any());
    }
    EXPECT_EQ(result.session_error, "");
  }

  std::filesystem::path folder;
  std::string recording;
  bool may_fault{false};  // a run may end with a fault, or have had one
  procedure::SurgicalPlan planned;
  std::vector<ProcedureTool> tool_table;
  int first_tool{0};
  bool scripted{true};
  std::unique_ptr<CellSetup> setup;
  std::unique_ptr<simulation::CuttingEngine> engine;
  std::unique_ptr<ProcedureSession> session;
  CellRunParams params;
  CellRunResult result;
};

}  // namespace osteon::session
