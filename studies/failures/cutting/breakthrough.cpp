#include "studies/failures/cutting/breakthrough.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include <fmt/format.h>

#include "safety/depth_limit.h"
#include "safety/workspace.h"
#include "simulation/bone/scene_events.h"
#include "simulation/solids/box_solid.h"
#include "studies/failures/scenario_bench.h"

namespace osteon::studies {
namespace {

// Push, mass and damping of the hand, and the period of frames.
constexpr double kPush_N = 100.0, kMass_kg = 2.0, kDamping_Ns_per_m = 200.0, kDt_s = 1e-3;
// Radius of the burr; half the width of the wall across the feed.
constexpr double kRadius_m = 1.6e-3, kHalfWidth_m = 4e-3;
// Our depth limit. Its bound lies kMargin_m beyond the pose at which the tool has cut through the wall. The
// limit resists from kSoft_m before the bound on, and stops the spindle kSpindleStop_m before the bound.
// kStop_m_per_s2 is the deceleration within the workspace.
constexpr double kMargin_m = 1e-3;
constexpr double kSoft_m = 3e-3, kSpindleStop_m = 0.5e-3, kLimit_N_per_m = 20e3, kStop_m_per_s2 = 3.0;
constexpr int kFramesAfter = 100;  // frames observed after the breakthrough

// The result of drilling through one wall.
struct DrillResult {
  double overshoot_m{0.0};  ///< travel of the hand below its height at the breakthrough
  /// Largest distance of the proxy ahead of the tool along the feed; -1: none seen.
  double lead_m{-1.0};
  std::optional<int> through;  ///< frame in which the proxy's apex has passed the wall's far side
  std::optional<int> flagged;  ///< frame in which SceneWatch reports the breakthrough
  FailureSeries hand;          ///< travel of the hand after the breakthrough [mm] by the time [ms]
};

// Drills until kFramesAfter after the breakthrough.
// @param held  true: our depth limit acts; false (the baseline): from the flag on no force acts on the hand
DrillResult Drill(simulation::CuttingEngine& engine, const simulation::Bone& wall,
                  const simulation::Solid& solid, double thickness_m, bool held,
                  const simulation::CuttingParams& params) {
  const simulation::Tool tool = MakeBallTool(kRadius_m);
  simulation::SceneWatch watch(&solid, wall, tool, {.min_wall_m = 1e-6});
  DrillResult drill_result;
  const safety::DepthLimitParams floor{
      .acts = held,
      .bound = {.shape = safety::ZoneShape::kHalfSpace,
                // A pushed tool is ahead of its proxy by the coupling's deflection. The limit lies that much
                // deeper, so that the wall is cut through.
                .p_W_m = {0.0, 0.0, -thickness_m - kPush_N / params.stiffness_N_per_m - kMargin_m}},
      .soft_m = kSoft_m,
      .spindle_stop_m = kSpindleStop_m,
      .stiffness_N_per_m = kLimit_N_per_m};
  safety::DepthLimit depth_limit(floor);
  safety::WorkspaceParams room{.deceleration_m_per_s2 = kStop_m_per_s2};
  if (held) room.zones.push_back(safety::ZoneOf(floor));
  const safety::Workspace workspace(room);
  double z = 0.05e-3, v = 0.0, broken_at_m = 0.0;
  constexpr int kMax = 20'000;
  for (int frame = 0; frame < kMax; ++frame) {
    const double spindle = depth_limit.stops_spindle() ? 0.0 : kScenarioSpindle_rad_per_s;
    const auto model = engine.Step(FrameAt(Downwards({0, 0, z}), spindle, kDt_s));
    const double proxy_m = Pose(model.X_WP).translation().z();
    drill_result.lead_m = std::max(drill_result.lead_m, z - proxy_m);
    if (!drill_result.through && proxy_m < -thickness_m) {
      drill_result.through = frame;
      broken_at_m = z;
    }
    if (!watch.Step(model.X_WP, model.removed_volume_m3, 0).empty() && !drill_result.flagged)
      drill_result.flagged = frame;
    double force_N = model.F_T_W.f.z + depth_limit.Step({0, 0, z}, {0, 0, v}).z();
    if (held)
      force_N = std::min(force_N, params.max_force_N);
    else if (drill_result.flagged)
      force_N = 0.0;
    if (drill_result.through) {
      drill_result.overshoot_m = std::max(drill_result.overshoot_m, broken_at_m - z);
      drill_result.hand.x.push_back(1e3 * kDt_s * (frame - *drill_result.through));
      drill_result.hand.y.push_back(1e3 * (broken_at_m - z));
      if (frame - *drill_result.through >= kFramesAfter) break;
    }
    v += kDt_s * (force_N - kPush_N - kDamping_Ns_per_m * v) / kMass_kg;
    v = workspace.Limit({0, 0, z}, {0, 0, v}, kDt_s).v_WT.z();
    z += kDt_s * v;
  }
  return drill_result;
}

}  // namespace

FailureResult RunBreakthrough(const FailureSetting& setting) {
  FailureResult result{.id = 19,
                       .name = "breakthrough",
                       .metric = "way of the hand after the breakthrough",
                       .unit = "mm",
                       .baseline_name = "the proxy jumps to the tool",
                       .bound = 3.0};
  const std::vector<double> walls_m =
      setting.full() ? std::vector{1e-3, 1.25e-3, 1.5e-3, 1.75e-3, 2e-3} : std::vector{1.2e-3};
  const simulation::CuttingParams params;
  double lead_m = -1.0;
  int latest = 0;
  bool complete = true, all_seen = true;
  result.plot = {.x_label = "time after the breakthrough [ms]",
                 .y_label = "way of the hand [mm]",
                 .bound_is_on_y = true};
  for (std::size_t i = 0; i < walls_m.size() && complete; ++i) {
    const double thickness_m = walls_m[i];
    const Vector3 low(-kHalfWidth_m, -kHalfWidth_m, -thickness_m), high(kHalfWidth_m, kHalfWidth_m, 0.0);
    simulation::Bone wall =
        MakeBlock({.low_m = low, .high_m = high, .ball_radius_m = 0.4e-3, .point_spacing_m = 0.25e-3});
    wall.site = {.center_m = Vector3::Zero(), .axis = Vector3(Vector3::UnitZ()), .radius_m = kRadius_m};
    const simulation::BoxSolid solid(low, high);
    const auto run = [&](bool held) {
      return Drill(*setting.make_engine(wall, MakeBallTool(kRadius_m), Pose::Identity(), params), wall, solid,
                   thickness_m, held, params);
    };
    DrillResult jumped = run(false), ours = run(true);
    result.baseline = std::max(result.baseline, 1e3 * jumped.overshoot_m);
    result.ours = std::max(result.ours, 1e3 * ours.overshoot_m);
    lead_m = std::max(lead_m, ours.lead_m);
    all_seen = all_seen && ours.through && ours.flagged && jumped.through;
    if (ours.through && ours.flagged) latest = std::max(latest, std::abs(*ours.flagged - *ours.through));
    if (i == 0) {
      jumped.hand.name = "the proxy jumps";
      ours.hand.name = "ours";
      ours.hand.ours = true;
      result.plot.series = {std::move(jumped.hand), std::move(ours.hand)};
    }
    complete = setting.GoesOn(static_cast<double>(i + 1) / static_cast<double>(walls_m.size()));
  }
  result.baseline_fails = result.baseline > result.bound;
  result.ours_passes = complete && all_seen && result.ours < result.bound && lead_m <= 1e-6 && latest <= 1;
  result.note = fmt::format("the proxy leads the tool by at most {:.4f} mm; flagged {} frames off{}",
                            1e3 * std::max(0.0, lead_m), latest,
                            all_seen ? "" : "; a wall was never passed or flagged");
  return result;
}

}  // namespace osteon::studies
