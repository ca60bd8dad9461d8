#include "session/planning/recorded_packing.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "session/planning/planned_cell.h"
#include "session/procedure/session_file.h"

namespace osteon::session {
namespace {

// Bounds of the lengths of a packing that are accepted from a recording; no plan exceeds them.
constexpr double kFinest_m = 0.01e-3, kCoarsest_m = 40e-3, kDeepest_m = 1.0, kMaxDemand_m = 5e-3;
constexpr std::uint32_t kMaxChildren = 1000;

std::string BallsChecksum(const std::vector<simulation::Ball>& balls) {
  static_assert(sizeof(simulation::Ball) == 4 * sizeof(double));  // no padding between the numbers
  return TextChecksum(
      std::string(reinterpret_cast<const char*>(balls.data()), balls.size() * sizeof(simulation::Ball)));
}

// Makes a packing record that has the packing's level and balls, but no demanded and no predicted figures.
io::PackingRecord RecordOf(const simulation::PackingLevel& level,
                           const std::vector<simulation::Ball>& balls) {
  return {.kind = static_cast<std::uint32_t>(level.kind),
          .spacing_m = level.fine.spacing_m,
          .radius_m = level.fine.radius_m,
          .surface_gap_m = level.fine.surface_gap_m,
          .children = static_cast<std::uint32_t>(level.fine.children),
          .zone_depth_m = level.zone_depth_m,
          .corner_m = level.corner_m,
          .unmet = {},
          .balls = balls.size(),
          .balls_checksum = BallsChecksum(balls)};
}

}  // namespace

io::PackingRecord MakePackingRecord(const CellSetup& setup) {
  const PlannedCell& planned = *setup.planned;
  const FidelityPlan& plan = planned.plan;
  io::PackingRecord record = RecordOf(plan.packed.level, setup.bone.balls);
  record.error_m = planned.request.error_m;
  record.rate_hz = planned.request.rate_hz;
  record.timed = planned.request.timed;
  record.expected_error_m = plan.error_m;
  record.promised_error_m = plan.promised_m;
  record.expected_frame_us = plan.frame_us;
  for (const UnmetDemand& demand : plan.unmet)
    record.unmet.push_back({.what = demand.what, .asked = demand.asked, .predicted = demand.predicted});
  return record;
}

io::PackingRecord MakePackingRecord(const Rezoned& rezoned) {
  io::PackingRecord record = RecordOf(rezoned.zones.level, rezoned.bone.balls);
  record.promised_error_m = rezoned.zones.promised_m;
  record.expected_frame_us = rezoned.zones.frame_us;
  record.seen_frame_us = rezoned.seen_us;
  return record;
}

tl::expected<simulation::PackingLevel, std::string> LevelOf(const io::PackingRecord& packing) {
  const auto refuse = [](const char* name, const std::string& found, const std::string& accepted) {
    return tl::make_unexpected(
        fmt::format("the recorded packing: {}: found {}, accepted {}", name, found, accepted));
  };
  if (packing.kind > static_cast<std::uint32_t>(simulation::PackingKind::kSplit))
    return refuse("kind", std::to_string(packing.kind), "0 … 2");
  if (packing.children > kMaxChildren)
    return refuse("children", std::to_string(packing.children), fmt::format("0 … {}", kMaxChildren));
  struct Length {
    const char* name;
    double found_m, min_m, max_m;
  };
  for (const Length& length : {Length{"spacing", packing.spacing_m, kFinest_m, kCoarsest_m},
                               Length{"radius", packing.radius_m, kFinest_m, kCoarsest_m},
                               Length{"surface gap", packing.surface_gap_m, 0.0, kCoarsest_m},
                               Length{"zone's depth", packing.zone_depth_m, 0.0, kDeepest_m},
                               Length{"corners", packing.corner_m, 0.0, kDeepest_m}})
    if (!(length.found_m >= length.min_m && length.found_m <= length.max_m))
      return refuse(length.name, fmt::format("{:g} mm", length.found_m * 1e3),
                    fmt::format("{:g} … {:g} mm", length.min_m * 1e3, length.max_m * 1e3));
  return simulation::PackingLevel{.kind = static_cast<simulation::PackingKind>(packing.kind),
                                  .fine = {.spacing_m = packing.spacing_m,
                                           .radius_m = packing.radius_m,
                                           .surface_gap_m = packing.surface_gap_m,
                                           .children = static_cast<int>(packing.children)},
                                  .zone_depth_m = packing.zone_depth_m,
                                  .corner_m = packing.corner_m};
}

std::string DescribeOtherBalls(const io::PackingRecord& packing, const simulation::Bone& bone) {
  if (bone.balls.size() == packing.balls && BallsChecksum(bone.balls) == packing.balls_checksum) return "";
  return fmt::format(
      "the bone was packed again: found {} balls ({}), accepted the run's {} ({}): another "
      "version made that recording",
      bone.balls.size(), BallsChecksum(bone.balls), packing.balls, packing.balls_checksum);
}

tl::expected<void, std::string> PackAsRecorded(CellSetup& setup,
                                               const std::optional<io::PackingRecord>& packing) {
  if (!setup.solid || !packing) {
    PackAsScene(setup);
    return {};
  }
  const auto level = LevelOf(*packing);
  if (!level) return tl::make_unexpected(level.error());
  if (!(packing->error_m > 0.0 && packing->error_m <= kMaxDemand_m))
    return tl::make_unexpected(
        fmt::format("the recorded packing: error: found {:g} mm, accepted more than 0, at most {:g} mm",
                    packing->error_m * 1e3, kMaxDemand_m * 1e3));
  const simulation::SceneSolid solid{.name = setup.bone.name, .solid = setup.solid, .site = setup.bone.site};
  auto planned = std::make_shared<PlannedCell>();
  planned->request = {.error_m = packing->error_m,
                      .rate_hz = packing->rate_hz,
                      .engine = {},
                      .rounds = 1,
                      .timed = packing->timed};
  FidelityPlan& plan = planned->plan;
  plan.error_m = packing->expected_error_m;
  plan.promised_m = packing->promised_error_m;
  plan.frame_us = packing->expected_frame_us;
  for (const io::PackingRecord::Unmet& unmet : packing->unmet)
    plan.unmet.push_back({.what = unmet.what, .asked = unmet.asked, .predicted = unmet.predicted});
  try {
    planned->scene = MakePlanScene(solid, setup.config.scene, setup.config, setup.cell_name);
    const PlanScene& scene = planned->scene;
    plan.tool = ToolForError(scene, packing->error_m);
    plan.packed = {.level = *level,
                   .balls = simulation::PackLevel(*level, *scene.work.solid, *scene.work.zone)};
    setup.bone = simulation::SceneBone(solid, setup.config.scene, plan.packed.balls, scene.points);
    setup.config.cutting = simulation::CuttingForLevel(*level, scene.cut, setup.config.cutting);
  } catch (const std::invalid_argument& error) {
    return tl::make_unexpected("the recorded packing: " + std::string(error.what()));
  }
  setup.config.tool.tool = plan.tool;
  if (const std::string other = DescribeOtherBalls(*packing, setup.bone); !other.empty())
    setup.bone_warning += (setup.bone_warning.empty() ? "" : "; ") + other;
  setup.planned = std::move(planned);
  return {};
}

}  // namespace osteon::session
