#include "studies/assess/surgical_plan_result.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/units.h"
#include "base/write_text.h"
#include "config/reading/check_plan_in_cell.h"
#include "config/reading/load.h"
#include "config/reading/load_surgical_plan.h"
#include "session/process/exit_code.h"
#include "session/setup/cell_bone.h"
#include "session/summary/verdict.h"

namespace osteon::studies {
namespace {

using Json = nlohmann::ordered_json;
using procedure::CupAngles;
using procedure::CupDefinition;
using procedure::SurgicalPlan;

constexpr double kLandmarkNoise_m = 2e-3;  // standard deviation of a palpated landmark's coordinate
// surface samples per radius of the opening, for the search of the thinnest wall
constexpr double kWallsPerRadius = 12.5;
constexpr CupDefinition kDefinitions[] = {CupDefinition::kRadiographic, CupDefinition::kOperative,
                                          CupDefinition::kAnatomic};

// A vector's three coordinates, multiplied by a scale that converts the unit.
Json Triple(const Vector3& v, double scale = 1.0) { return {scale * v.x(), scale * v.y(), scale * v.z()}; }

Json AnglesJson(const CupAngles& angles) {
  return {{"inclination_deg", angles.inclination_rad / kDegree},
          {"anteversion_deg", angles.anteversion_rad / kDegree}};
}

// Number of cells per radius for measuring the planned volume. An opening gets fewer cells: it usually lies
// in a solid that is made from a mesh, where distance queries take longer.
double CellsPerRadius(procedure::PlanKind kind) { return kind == procedure::PlanKind::kCup ? 50.0 : 25.0; }

// Figures that are measured for the plan, in addition to its own data.
struct PlanFigures {
  std::optional<double> planned_volume_m3{};  // empty: the plan is for a mesh, and no mesh was given
  // volume that each tool removes after the earlier tools; empty: not known
  std::vector<double> tool_volumes_m3{};
  std::optional<double> wall_m{};   // thinnest wall of bone that the cavity leaves; empty: not known
  std::optional<Vector3> axis_W{};  // the plan's axis in the cell's world; empty: no cell was given
  std::vector<std::string> warnings;
};

// The volume of bone that each tool removes after the earlier tools have cut at their planned places.
std::vector<double> ToolVolumes(const SurgicalPlan& plan, const session::CellSetup& setup) {
  std::vector<procedure::PlannedCavity> cleared;
  std::vector<double> volumes_m3;
  for (const procedure::PlannedTool& tool : plan.tools) {
    const procedure::PlannedCavity cavity = plan.CavityOf(tool);
    if (setup.solid) {
      volumes_m3.push_back(procedure::BoneInCavity(
          *setup.solid, cavity, plan.cavity().opening_radius_m() / CellsPerRadius(plan.kind), cleared));
    } else {
      const auto is_gone = [&](const Vector3& p_m) {
        return std::ranges::any_of(cleared, [&](const auto& c) { return c.DistanceTo(p_m) < 0.0; });
      };
      double volume_m3 = 0.0;
      for (const simulation::MassPoint& point : setup.bone.points)
        if (cavity.DistanceTo(point.p_m) < 0.0 && !is_gone(point.p_m)) volume_m3 += point.volume_m3;
      volumes_m3.push_back(volume_m3);
    }
    cleared.push_back(cavity);
  }
  return volumes_m3;
}

// Measures the plan's volumes and its thinnest wall. Without a solid, the volumes are sums over the packing's
// mass points, and the wall is not measured.
tl::expected<PlanFigures, std::string> Measure(const config::SurgicalPlanConfig& config,
                                               std::optional<session::MeshChoice> mesh) {
  PlanFigures figures{.warnings = procedure::WarningsOf(config.plan)};
  if (config.mesh_cup && !mesh) return figures;
  if (mesh) mesh->cup = config.mesh_cup;
  session::CellSetup setup;
  setup.config.scene = config.scene;
  setup.config.bone = config.bone;
  if (const auto made = session::MakeCellBone(setup, mesh); !made) return tl::make_unexpected(made.error());
  const procedure::PlannedCavity cavity = config.plan.cavity();
  figures.tool_volumes_m3 = ToolVolumes(config.plan, setup);
  if (!setup.bone_warning.empty()) figures.warnings.push_back("bone: " + setup.bone_warning);
  if (setup.solid) {
    figures.planned_volume_m3 = procedure::BoneInCavity(
        *setup.solid, cavity, cavity.opening_radius_m() / CellsPerRadius(config.plan.kind));
    figures.wall_m = procedure::PlannedWall(*setup.solid, setup.bone.site, cavity,
                                            cavity.opening_radius_m() / kWallsPerRadius);
    const double min_wall_m = config.scene.events.min_wall_m;
    if (figures.wall_m && *figures.wall_m < min_wall_m)
      figures.warnings.push_back(
          fmt::format("wall: found {:.2f} mm left, the scene watches for less than {:g} mm",
                      1e3 * *figures.wall_m, 1e3 * min_wall_m));
  } else {
    double volume_m3 = 0.0;
    for (const simulation::MassPoint& point : setup.bone.points)
      if (cavity.DistanceTo(point.p_m) < 0.0) volume_m3 += point.volume_m3;
    figures.planned_volume_m3 = volume_m3;
  }
  return figures;
}

// Adds the planned volume, the wall and the warnings to a plan's JSON.
void AddFigures(const PlanFigures& figures, Json& json) {
  json["planned_volume_mm3"] = figures.planned_volume_m3 ? Json(1e9 * *figures.planned_volume_m3) : Json();
  json["least_wall_mm"] = figures.wall_m ? Json(1e3 * *figures.wall_m) : Json();
  json["warnings"] = figures.warnings;
}

// Volume of the i-th tool; null: not known.
Json VolumeJson(const PlanFigures& figures, std::size_t i) {
  return i < figures.tool_volumes_m3.size() ? Json(1e9 * figures.tool_volumes_m3[i]) : Json();
}

Json OpeningJson(const SurgicalPlan& plan, const PlanFigures& figures) {
  Json json{{"schema", "osteon.surgical_plan/1"},
            {"plan", plan.name},
            {"kind", "opening"},
            {"target", plan.target},
            {"axis_G", Triple(plan.axis_G)},
            {"width_mm", 2e3 * plan.cavity().opening_radius_m()}};
  if (figures.axis_W) json["axis_W"] = Triple(*figures.axis_W);
  for (std::size_t i = 0; i < plan.tools.size(); ++i)
    json["burrs"].push_back({{"diameter_mm", 1e3 * plan.tools[i].diameter_m},
                             {"width_mm", 1e3 * plan.tools[i].width_m()},
                             {"centre_mm", Triple(plan.CentreOf(plan.tools[i]), 1e3)},
                             {"volume_mm3", VolumeJson(figures, i)}});
  AddFigures(figures, json);
  return json;
}

Json PlanJson(const SurgicalPlan& plan, const PlanFigures& figures) {
  if (plan.kind == procedure::PlanKind::kOpening) return OpeningJson(plan, figures);
  Json json{{"schema", "osteon.surgical_plan/1"},
            {"plan", plan.name},
            {"kind", "cup"},
            {"side", procedure::NameOf(plan.side)},
            {"definition", procedure::NameOf(plan.definition)},
            {"axis_G", Triple(plan.axis_G)}};
  if (figures.axis_W) json["axis_W"] = Triple(*figures.axis_W);
  for (const CupDefinition definition : kDefinitions)
    json["angles"][procedure::NameOf(definition)] =
        AnglesJson(procedure::AnglesOf(definition, plan.pelvis.FromG(plan.axis_G)));
  if (plan.landmarks) {
    json["landmark_noise"]["sd_mm"] = 1e3 * kLandmarkNoise_m;
    for (const CupDefinition definition : kDefinitions)
      json["landmark_noise"][procedure::NameOf(definition)] = AnglesJson(procedure::LandmarkSpread(
          *plan.landmarks, plan.side, plan.tilt_rad, definition, plan.axis_G, kLandmarkNoise_m));
  }
  for (std::size_t i = 0; i < plan.tools.size(); ++i)
    json["reamers"].push_back({{"diameter_mm", 1e3 * plan.tools[i].diameter_m},
                               {"centre_mm", Triple(plan.CentreOf(plan.tools[i]), 1e3)},
                               {"volume_mm3", VolumeJson(figures, i)}});
  AddFigures(figures, json);
  return json;
}

std::string AxisText(const Vector3& axis) {
  constexpr double kShown = 1e4;  // shows four places; + 0.0 turns "-0" into "0"
  const auto rounded = [](double v) { return std::round(v * kShown) / kShown + 0.0; };
  return fmt::format("{:.4f}, {:.4f}, {:.4f}", rounded(axis.x()), rounded(axis.y()), rounded(axis.z()));
}

std::vector<report::SummaryRow> PlanRows(const SurgicalPlan& plan, const PlanFigures& figures) {
  const bool is_opening = plan.kind == procedure::PlanKind::kOpening;
  std::vector<report::SummaryRow> rows{
      {"Plan",
       is_opening ? fmt::format("{}, an opening of {:.4g} mm to the {}", plan.name,
                                2e3 * plan.cavity().opening_radius_m(), plan.target)
                  : fmt::format("{}, {} hip, cup {:g} mm, {} angles", plan.name, procedure::NameOf(plan.side),
                                1e3 * plan.cup_diameter_m, procedure::NameOf(plan.definition))},
      {"Axis in G, out of the opening", AxisText(plan.axis_G)}};
  if (figures.axis_W) rows.push_back({"Axis in W", AxisText(*figures.axis_W)});
  for (const CupDefinition definition : kDefinitions) {
    if (is_opening) break;
    const CupAngles angles = procedure::AnglesOf(definition, plan.pelvis.FromG(plan.axis_G));
    std::string text = fmt::format("inclination {:.4f}°, anteversion {:.4f}°",
                                   angles.inclination_rad / kDegree, angles.anteversion_rad / kDegree);
    if (plan.landmarks) {
      const CupAngles sd = procedure::LandmarkSpread(*plan.landmarks, plan.side, plan.tilt_rad, definition,
                                                     plan.axis_G, kLandmarkNoise_m);
      text += fmt::format("  (landmarks ± {:g} mm: ± {:.2f}°, ± {:.2f}°)", 1e3 * kLandmarkNoise_m,
                          sd.inclination_rad / kDegree, sd.anteversion_rad / kDegree);
    }
    rows.push_back({fmt::format("Angles, {}", procedure::NameOf(definition)), text});
  }
  std::string reamers;
  for (const procedure::PlannedTool& reamer : plan.tools)
    reamers += fmt::format("{}{:g}", reamers.empty() ? "" : ", ", 1e3 * reamer.diameter_m);
  rows.push_back({is_opening ? "Burrs" : "Reamers", reamers + " mm"});
  rows.push_back({"Bone in the planned cavity",
                  figures.planned_volume_m3 ? fmt::format("{:.0f} mm³", 1e9 * *figures.planned_volume_m3)
                                            : "not known: name the plan's mesh with --mesh"});
  std::string volumes;
  for (const double volume_m3 : figures.tool_volumes_m3)
    volumes += fmt::format("{}{:.{}f}", volumes.empty() ? "" : ", ", 1e9 * volume_m3, is_opening ? 1 : 0);
  if (!volumes.empty())
    rows.push_back(
        {is_opening ? "Bone that each burr takes" : "Bone that each reamer takes", volumes + " mm³"});
  rows.push_back({"Thinnest wall that it leaves",
                  figures.wall_m ? fmt::format("{:.2f} mm", 1e3 * *figures.wall_m) : "not known"});
  return rows;
}

}  // namespace

int RunSurgicalPlan(const SurgicalPlanOptions& options) {
  const config::SurgicalPlanConfig config = config::LoadSurgicalPlan(options.plan);
  std::optional<Vector3> axis_W{};
  if (!options.cell.empty()) {
    const config::CellConfig cell = config::LoadCell(options.cell);
    config::CheckPlanInCell(config, cell, options.plan, options.cell);
    axis_W = config::BoneInWorld(cell, config.site).linear() * config.plan.axis_G;
  }
  if (options.mesh && !config.mesh_cup)
    return session::Fail("surgical-plan",
                         fmt::format("--mesh: found with {}, accepted without: the plan names its bone",
                                     options.plan.string()));
  auto figures = Measure(config, options.mesh);
  if (!figures) return session::Fail("surgical-plan", figures.error());
  figures->axis_W = axis_W;
  session::Verdict verdict;
  for (const std::string& warning : figures->warnings) verdict.Add(session::VerdictLevel::kWarning, warning);
  constexpr int kKeyWidth = 31;
  session::PrintVerdict(verdict, kKeyWidth - 1);
  for (const report::SummaryRow& row : PlanRows(config.plan, *figures))
    fmt::print("  {:<{}}{}\n", row.key, kKeyWidth, row.value);
  if (!options.json.empty())
    if (const auto written =
            base::WriteText(options.json, session::ResultText(verdict, PlanJson(config.plan, *figures)));
        !written)
      return session::Fail("surgical-plan", written.error(), session::kFailed);
  return 0;
}

}  // namespace osteon::studies
