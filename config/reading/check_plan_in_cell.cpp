#include "config/reading/check_plan_in_cell.h"

#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "config/reading/strict/config_error.h"
#include "safety/zone.h"
#include "simulation/solids/cup_frame.h"

namespace osteon::config {

Pose BoneInWorld(const CellConfig& cell, const simulation::CutSite& site) {
  return cell.X_WG * simulation::CupPose(site).inverse();
}

void CheckPlanInCell(const SurgicalPlanConfig& config, const CellConfig& cell,
                     const std::filesystem::path& plan_file, const std::filesystem::path& cell_file) {
  constexpr double kSame_m = 1e-6;  // cups whose centres and radii differ by no more are the same
  const simulation::CutSite& plan_site = config.site;
  const std::optional<simulation::CutSite> cell_site =
      cell.bone ? cell.bone->cup : simulation::MakeSceneSolid(cell.scene).site;
  const auto describe = [](const simulation::CutSite& at) {
    return fmt::format("{:.4g}, {:.4g}, {:.4g} mm, radius {:.4g} mm", 1e3 * at.center_m.x,
                       1e3 * at.center_m.y, 1e3 * at.center_m.z, 1e3 * at.radius_m);
  };
  // the mesh of the command line replaces the cell's bone
  const bool is_replaced = config.mesh_cup && !cell.bone;
  if (cell_site && !is_replaced &&
      ((Vector3(cell_site->center_m) - Vector3(plan_site.center_m)).norm() > kSame_m ||
       std::abs(cell_site->radius_m - plan_site.radius_m) > kSame_m))
    throw ConfigError(plan_file.string(), 0,
                      fmt::format("found a plan for a cup at {}, accepted for {}: that of {}",
                                  describe(plan_site), describe(*cell_site), cell_file.string()));
  const safety::DepthLimitParams& depth = cell.servo.depth;
  if (!depth.acts) return;
  const Pose X_WG = BoneInWorld(cell, plan_site);
  for (const procedure::PlannedTool& reamer : config.plan.tools) {
    const double to_bound_m = safety::ZoneBounds(depth.bound, X_WG * config.plan.ApexOf(reamer)).distance_m();
    if (to_bound_m < depth.soft_m)
      throw ConfigError(
          cell_file.string(), 0,
          fmt::format("depth_limit: found a resistance from {:.4g} mm before the bound on, accepted at most "
                      "{:.4g}: the reamer of {:.4g} mm of {} ends there",
                      1e3 * depth.soft_m, 1e3 * to_bound_m, 1e3 * reamer.diameter_m, plan_file.string()));
  }
}

}  // namespace osteon::config
