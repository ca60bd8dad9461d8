#include "config/reading/file_kinds.h"

#include "config/reading/load.h"
#include "config/reading/load_identified.h"
#include "config/reading/load_robot.h"
#include "config/reading/load_rubric.h"
#include "config/reading/load_scenario.h"
#include "config/reading/load_surgical_plan.h"
#include "config/reading/load_sweep.h"
#include "config/reading/sections/read_calibration.h"
#include "config/reading/sections/read_gains.h"

namespace osteon::config {

std::vector<FileKind> FileKinds() {
  return {
      {"cell", "cells", [](const auto& file) { static_cast<void>(LoadCell(file)); }},
      {"robot", "robots", [](const auto& file) { static_cast<void>(LoadRobot(file)); }},
      {"tool", "tools", [](const auto& file) { static_cast<void>(LoadTool(file)); }},
      {"scene", "scenes", [](const auto& file) { static_cast<void>(LoadScene(file)); }},
      {"materials", "materials", [](const auto& file) { static_cast<void>(LoadMaterials(file)); }},
      {"scenario", "scenarios", [](const auto& file) { static_cast<void>(LoadScenario(file)); }},
      {"sweep", "sweeps", [](const auto& file) { static_cast<void>(LoadSweep(file)); }},
      {"plan", "plans", [](const auto& file) { static_cast<void>(LoadSurgicalPlan(file)); }},
      {"rubric", "rubrics", [](const auto& file) { static_cast<void>(LoadRubric(file)); }},
      {"gains", "",
       [](const auto& file) {
         control::AdmittanceParams admittance;
         control::CouplingParams coupling;
         ApplyGainsFile(file, control::Law::kAdmittance, admittance, coupling);
       }},
      {"calibration", "",
       [](const auto& file) {
         CellConfig cell;
         ApplyCalibration(file, cell);
       }},
      {"identified", "", [](const auto& file) { static_cast<void>(ReadIdentified(file)); }},
  };
}

}  // namespace osteon::config
