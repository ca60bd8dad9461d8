#include "session/planning/plan.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "simulation/fidelity/accuracy.h"
#include "simulation/fidelity/disjoint_balls.h"
#include "simulation/fidelity/thin_tool.h"
#include "simulation/tools/tool_path.h"

namespace osteon::session {
namespace {

using simulation::PackingKind;
using simulation::PackingLevel;

// Fractions of the demanded error: removal and tool together may cause 0.8 of it, the tool alone 0.1. The
// rest is a reserve, because the closed forms of the error are accurate to a fifth.
constexpr double kRemovalShare = 0.8, kToolShare = 0.1;
constexpr double kCoarser = 1.2;      // factor by which the error is raised if frames take too long
constexpr double kMaxError_m = 5e-3;  // no packing with a larger error is planned
constexpr double kMaxBalls = 20e6;    // no packing with more balls is planned
// Split packings are considered only if the other kinds need more balls than this. For the same error a frame
// of split balls takes 1.2 to 44 times as long as a frame of graded balls (packing_kinds.csv). A split
// packing needs a tenth of the balls, but this is an advantage only if the bone could not be packed
// otherwise.
constexpr double kManyBalls = 500e3;

/// Chooses the kind of packing that reaches the error with the shortest expected frames. Of the two kinds
/// without splitting this is the one with fewer balls. If both have more than kManyBalls balls, or if the cut
/// goes through a thin wall, split packings are considered too, and the kind with the fewest balls after the
/// cut, children included, is chosen. (At the rim of a hole through a wall, graded balls leave more bone than
/// the closed forms predict.)
std::optional<PackingLevel> ChooseLevel(const PlanScene& scene, const simulation::DepthVolumes& volumes,
                                        double error_m) {
  std::optional<PackingLevel> best;
  double fewest = kMaxBalls;
  for (const PackingKind kind : {PackingKind::kUniform, PackingKind::kGraded, PackingKind::kSplit}) {
    const auto level = simulation::CoarsestLevel(kind, error_m, scene.cut, scene.zone_depth_m);
    if (!level) continue;
    const double balls = volumes.ExpectedBalls(*level) + simulation::ExpectedChildren(*level, scene.cut);
    if (balls >= fewest) continue;
    // kSplit is tried last, after the other kinds
    if (kind == PackingKind::kSplit && best && fewest <= kManyBalls && scene.cut.wall_m == 0.0) continue;
    fewest = balls;
    best = level;
  }
  return best;
}

/// Expected number of balls of a uniform packing that reaches the error; 0 if none reaches it.
double UniformBalls(const PlanScene& scene, const simulation::DepthVolumes& volumes, double error_m) {
  const auto level = simulation::CoarsestLevel(PackingKind::kUniform, error_m, scene.cut, scene.zone_depth_m);
  return level ? volumes.ExpectedBalls(*level) : 0.0;
}

/// Two packings of one kind, with the measured times of their frames.
struct Calibration {
  std::string engine, device;
  std::vector<PackedLevel> others;
  std::vector<simulation::FrameGroup> groups;
  double reach_ratio{1.0};  ///< number of active balls of a frame, divided by the number of balls within
                            ///< reach before the cut
};

/// Packs the scene's solid at a level of fineness.
PackedLevel PackBalls(const PlanScene& scene, const PackingLevel& level) {
  return {.level = level, .balls = simulation::PackLevel(level, *scene.work.solid, *scene.work.zone)};
}

/// Measures the frame times of two other packings than the planned one. They are coarser, or finer if a thin
/// wall allows no coarser one.
tl::expected<Calibration, std::string> Calibrate(const PlanScene& scene, const PackingLevel& level,
                                                 const simulation::Tool& tool, const PlanRequest& request) {
  std::vector<double> factors{1.15, 1.8};  // factors on the planned level's spacing
  if (!simulation::FitsWall(simulation::Scaled(level, factors.back(), scene.cut), scene.cut))
    factors = {1.0 / 1.15, 1.0 / 1.5};
  Calibration calibration;
  std::vector<PackedLevel>& others = calibration.others;
  for (const double factor : factors)
    others.push_back(PackBalls(scene, simulation::Scaled(level, factor, scene.cut)));
  const auto runs = RunLevels(scene, others, tool, request.engine, request.rounds);
  if (!runs) return tl::make_unexpected(runs.error());
  calibration.engine = runs->front().engine;
  calibration.device = runs->front().device;
  double ratios = 0.0;
  for (std::size_t i = 0; i < others.size(); ++i) {
    calibration.groups.push_back(simulation::GroupOf((*runs)[i].frames));
    ratios += calibration.groups.back().active_balls / std::max(1.0, BallsInReach(scene, others[i].balls));
  }
  calibration.reach_ratio = ratios / static_cast<double>(others.size());
  return calibration;
}

/// Packs the level, and predicts the error of a cut in it.
void SetPackedLevel(FidelityPlan& plan, const PlanScene& scene, const PackingLevel& level) {
  plan.packed = PackBalls(scene, level);
  plan.removal = simulation::PredictRemovalError(level.fine, scene.cut);
  plan.error_m = plan.removal.total_m() + plan.tool_gap_m;
}

/// Predicts the frame time of the packed level.
void PredictFrameTime(FidelityPlan& plan, const PlanScene& scene, const Calibration& calibration) {
  plan.engine = calibration.engine;
  plan.device = calibration.device;
  plan.others = calibration.others;
  plan.calibration = calibration.groups;
  plan.cost = simulation::FitFrameCost(calibration.groups);
  plan.active_balls = calibration.reach_ratio * BallsInReach(scene, plan.packed.balls);
  plan.frame_us = plan.cost.At(plan.active_balls);
  plan.frame_p999_us = plan.cost.tail_ratio * plan.frame_us;
}

/// Chooses the tool for an error and measures its gap. Leaves the level empty.
ModelChoice ChooseTool(const PlanScene& scene, double error_m) {
  ModelChoice model{.tool = ToolForError(scene, error_m), .level = {}};
  model.tool_gap_m = simulation::MeanCuttingGap(scene.work.tool, model.tool);
  return model;
}

}  // namespace

simulation::Tool ToolForError(const PlanScene& scene, double error_m) {
  return simulation::ThinTool(scene.work.tool, kToolShare * error_m);
}

double RemovalShare(double error_m, double tool_gap_m) { return kRemovalShare * error_m - tool_gap_m; }

ModelChoice ChooseModel(const PlanScene& scene, double error_m) {
  ModelChoice model = ChooseTool(scene, error_m);
  const simulation::DepthVolumes volumes(*scene.work.solid, *scene.work.zone);
  model.level = ChooseLevel(scene, volumes, RemovalShare(error_m, model.tool_gap_m));
  return model;
}

tl::expected<FidelityPlan, std::string> MakePlan(const PlanScene& scene, const PlanRequest& request,
                                                 const std::function<void(const std::string&)>& say) {
  const auto tell = [&](const char* text) {
    if (say) say(text);
  };
  tell("choose");
  FidelityPlan plan;
  const ModelChoice model = ChooseTool(scene, request.error_m);
  plan.tool = model.tool;
  plan.tool_gap_m = model.tool_gap_m;
  const simulation::DepthVolumes volumes(*scene.work.solid, *scene.work.zone);
  const double removal_m = RemovalShare(request.error_m, model.tool_gap_m);
  plan.uniform_balls = UniformBalls(scene, volumes, removal_m);
  plan.disjoint_balls = simulation::PredictDisjointBalls(request.error_m, volumes.volume_m3());
  const double max_us = 1e6 / request.rate_hz;
  std::map<PackingKind, Calibration> calibrations;
  std::optional<PackingLevel> level;
  std::optional<FidelityPlan> finest;
  for (double target_m = removal_m; target_m < kMaxError_m; target_m *= kCoarser) {
    const auto next = ChooseLevel(scene, volumes, target_m);
    if (!next) continue;  // no packing reaches this error: try a larger one
    if (level && next->kind == level->kind && next->fine.spacing_m <= level->fine.spacing_m)
      break;  // there is no coarser packing
    level = next;
    if (!request.timed) {
      SetPackedLevel(plan, scene, *level);
      break;
    }
    if (!calibrations.contains(level->kind)) {
      tell("time other packings");
      auto timed = Calibrate(scene, *level, plan.tool, request);
      if (!timed) return tl::make_unexpected(timed.error());
      calibrations.emplace(level->kind, std::move(*timed));
    }
    SetPackedLevel(plan, scene, *level);
    PredictFrameTime(plan, scene, calibrations.at(level->kind));
    if (!finest) finest = plan;
    // if a frame takes too long even without any balls, a coarser packing does not help
    if (plan.frame_us <= max_us || plan.cost.base_us >= max_us) break;
  }
  if (finest && plan.frame_us > max_us) plan = std::move(*finest);  // no coarser packing reaches the rate
  if (!level) return tl::make_unexpected("no packing of this bone serves a cut by this tool");
  // if the packing is coarser than demanded, promise the error for which it would have been chosen
  plan.promised_m = std::max(request.error_m, plan.error_m / kRemovalShare);
  if (plan.promised_m > (1.0 + 1e-6) * request.error_m)
    plan.unmet.push_back(
        {.what = "error", .asked = request.error_m * 1e3, .predicted = plan.promised_m * 1e3});
  if (plan.frame_us > max_us)
    plan.unmet.push_back({.what = "rate", .asked = request.rate_hz, .predicted = 1e6 / plan.frame_us});

  plan.arm = simulation::LowestArmLevel(scene.arm, request.error_m);
  plan.arm_error_m = simulation::ArmError(plan.arm, scene.arm);
  plan.turn_parts =
      simulation::ChordCount(scene.max_turn_rad_per_s / request.rate_hz, simulation::ToolLever(plan.tool));
  plan.leak_probe_m = std::min(1e-3, 0.5 * scene.cut.tool_radius_m);
  plan.leak_m = simulation::PredictLeak(plan.packed.level.fine, scene.cut, plan.leak_probe_m);
  plan.cogging = simulation::PredictCogging(plan.packed.level.fine, scene.cut.tool_radius_m);
  return plan;
}

std::optional<CoarserZones> CoarserFor(const PlanScene& scene, const FidelityPlan& plan,
                                       const PackingLevel& level, double seen_us, double max_us) {
  // a level with spacing a has the plan's number of active balls times (a_plan / a)²
  const double planned_m = plan.packed.level.fine.spacing_m;
  const auto model_us = [&](const PackingLevel& at) {
    const double ratio = planned_m / at.fine.spacing_m;
    return plan.cost.At(plan.active_balls * ratio * ratio);
  };
  const double measured_ratio = seen_us / model_us(level);
  for (double factor = kCoarser;; factor *= kCoarser) {
    const PackingLevel coarser = simulation::Scaled(level, factor, scene.cut);
    const double error_m =
        simulation::PredictRemovalError(coarser.fine, scene.cut).total_m() + plan.tool_gap_m;
    if (!simulation::IsInValidRange(coarser, scene.cut) || error_m > kMaxError_m) return std::nullopt;
    const double frame_us = measured_ratio * model_us(coarser);
    if (frame_us <= max_us)
      return CoarserZones{.level = coarser, .promised_m = error_m / kRemovalShare, .frame_us = frame_us};
  }
}

tl::expected<PlanCheck, std::string> CheckPlan(const PlanScene& scene, const PlanRequest& request,
                                               const FidelityPlan& plan) {
  std::vector<PackedLevel> levels{plan.packed};
  levels.insert(levels.end(), plan.others.begin(), plan.others.end());
  const auto runs = RunLevels(scene, levels, plan.tool, request.engine, request.rounds);
  if (!runs) return tl::make_unexpected(runs.error());
  const LevelRun& run = runs->front();
  const simulation::CutAccuracy cut = MeasureLevel(scene, plan.packed, run, plan.leak_probe_m);
  PlanCheck check;
  check.lost_m = cut.depth_error_m;
  check.left_m = cut.MeanLeft_m();
  check.error_m = check.lost_m + check.left_m;
  check.standard_error_m = cut.depth_error_se_m;
  check.leak_m = cut.probes.front().mean_m;
  check.frames = simulation::GroupOf(run.frames);
  std::vector<simulation::FrameGroup> others;
  for (std::size_t i = 1; i < runs->size(); ++i) others.push_back(simulation::GroupOf((*runs)[i].frames));
  check.same_time_us = simulation::FitFrameCost(others).At(plan.active_balls);

  const auto is_unmet = [&](const char* what) {
    return std::ranges::any_of(plan.unmet, [&](const UnmetDemand& demand) { return demand.what == what; });
  };
  if (check.error_m > plan.promised_m)
    check.missed.push_back(fmt::format("error: measured {:.4f} mm, promised {:.4f} mm", check.error_m * 1e3,
                                       plan.promised_m * 1e3));
  if (const double max_us = 1e6 / request.rate_hz; check.frames.p50_us > max_us && !is_unmet("rate"))
    check.missed.push_back(fmt::format("frame: measured {:.0f} us, {:.0f} us at {:g} Hz", check.frames.p50_us,
                                       max_us, request.rate_hz));
  return check;
}

}  // namespace osteon::session
