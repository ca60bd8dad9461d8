#include "studies/failures/compliance/depth_on_mount.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "studies/failures/compliance/law_trial.h"
#include "studies/failures/scenario_bench.h"

namespace osteon::studies {
namespace {

constexpr double kTick_s = 1e-3, kPush_N = 120.0, kPushRise_s = 1.0;
constexpr double kPlanned_m = 2e-3;  // depth of the hole
// The spindle stops at this distance before the bound of the depth limit.
constexpr double kSpindleStop_m = 1e-3;
constexpr double kSoft_m = 3e-3;  // the depth limit resists from this distance before its bound on
// The impedance law with an overlay of 4 ms and 40 N s/m of damping is stable with it.
constexpr double kImpedance_N_per_m = 10e3;
constexpr int kMaxTicks = 20'000, kTicksAfterStop = 300;  // ticks in all, and ticks after the spindle stopped

constexpr double kAbove_m = 0.05e-3;  // height of the apex over the bone at the beginning

// The outcome of one hole.
struct HoleResult {
  double depth_m{0.0};  ///< depth of the hole
  bool stopped{false};  ///< the limit has stopped the spindle
  bool fault{false};
  FailureSeries series;
};

// The loop with a depth limit that stops the spindle when the proxy is at the planned depth.
control::ServoParams Loop(control::Law law, double stiffness_N_per_m, const Pose& X_WG,
                          const std::optional<control::BoneMountParams>& mount, bool rides_on_bone) {
  control::ServoParams loop = LoopOfLaw(law, stiffness_N_per_m);
  if (law == control::Law::kAdmittance) loop.admittance.damping_Ns_per_m.setConstant(100.0);
  loop.compliance.mount = mount;
  if (mount) loop.compliance.mount->p_WMo_m = X_WG.translation();
  // A pressed tool is ahead of its proxy by the coupling's deflection under the push, less the depth limit's
  // resistance at the spindle's stop.
  const double ahead_m = (kPush_N - stiffness_N_per_m * (kSoft_m - kSpindleStop_m)) / stiffness_N_per_m;
  loop.depth = {.acts = true,
                .bound = {.shape = safety::ZoneShape::kHalfSpace,
                          .p_W_m = X_WG * Vector3(0.0, 0.0, -kPlanned_m - ahead_m - kSpindleStop_m),
                          .R_W = X_WG.linear()},
                .soft_m = kSoft_m,
                .spindle_stop_m = kSpindleStop_m,
                .stiffness_N_per_m = stiffness_N_per_m,
                .rides_on_bone = rides_on_bone};
  loop.spindle_rad_per_s = kScenarioSpindle_rad_per_s;
  return loop;
}

// Presses a turning burr into the bone until kTicksAfterStop after the depth limit has stopped the spindle.
// @param mount          none: the bone is fixed in the world
// @param rides_on_bone  the depth limit moves with the bone; false: it is fixed in the world
HoleResult Ream(const FailureSetting& setting, const simulation::Bone& bone, control::Law law,
                const std::optional<control::BoneMountParams>& mount, bool rides_on_bone) {
  const Pose X_WG = BoneOfLawTrial() * Eigen::Translation3d(0.0, 0.0, -kAbove_m);
  simulation::CuttingParams cutting;
  if (law == control::Law::kImpedance) cutting.stiffness_N_per_m = kImpedance_N_per_m;
  const auto engine = setting.make_engine(bone, MakeBallTool(5e-3), X_WG, cutting);
  HoleResult hole_result;
  bool has_turned = false;
  int ticks_since_stop = 0;
  PushingHand hand;
  const LawScene scene{.hand =
                           [&](int tick, const Pose& X_WT, const Twist& V_WT) {
                             return hand.Step(RisingPush(kPush_N, kTick_s * tick, kPushRise_s), X_WT, V_WT);
                           },
                       .bone =
                           [&](const simulation::ToolCommand& command) {
                             const double spindle = command.spindle_rad_per_s;
                             has_turned |= spindle > 0.0;
                             hole_result.stopped = has_turned && spindle == 0.0;
                             simulation::ContactModel model =
                                 engine->Step(FrameAt(Pose(command.X_WT), spindle, kTick_s));
                             const Vector3 p_G = X_WG.inverse() * Pose(model.X_WP).translation();
                             hole_result.depth_m = std::max(hole_result.depth_m, -p_G.z());
                             return model;
                           },
                       .seen =
                           [&](int tick, const LawTrialTick&) {
                             if (hole_result.stopped) ++ticks_since_stop;
                             if (tick % 10 == 0) {
                               hole_result.series.x.push_back(kTick_s * tick);
                               hole_result.series.y.push_back(1e3 * hole_result.depth_m);
                             }
                             return ticks_since_stop < kTicksAfterStop;
                           }};
  const double max_s = kTick_s * kMaxTicks;
  hole_result.fault =
      RunLawTrial(
          {.loop = Loop(law, cutting.stiffness_N_per_m, X_WG, mount, rides_on_bone), .seconds = max_s}, scene)
          .Any();
  return hole_result;
}

}  // namespace

FailureResult RunDepthOnMount(const FailureSetting& setting) {
  FailureResult result{.id = 41,
                       .name = "depth on a mount",
                       .metric = "error of the hole's depth",
                       .unit = "mm",
                       .baseline_name = "a depth limit that rests in the world",
                       .bound = 0.1};
  const simulation::Bone bone = MakeBlock({.low_m = {-6e-3, -6e-3, -5e-3},
                                           .high_m = {6e-3, 6e-3, 0.0},
                                           .ball_radius_m = 0.6e-3,
                                           .point_spacing_m = 0.5e-3});
  control::BoneMountParams elastic, creeping;  // 12 kg at 10 Hz
  creeping.creep_N_per_m = 60e3;
  bool complete = true, all_stopped = true, fault = false;
  double shallowest_m = 1.0, rest_m = 0.0;
  for (const control::Law law : {control::Law::kAdmittance, control::Law::kImpedance}) {
    HoleResult rest = Ream(setting, bone, law, {}, false);
    rest_m = rest.depth_m;
    all_stopped = all_stopped && rest.stopped;
    for (const control::BoneMountParams& mount : {elastic, creeping}) {
      HoleResult world = Ream(setting, bone, law, mount, false);
      HoleResult ours = Ream(setting, bone, law, mount, true);
      all_stopped = all_stopped && world.stopped && ours.stopped;
      fault = fault || rest.fault || ours.fault;
      shallowest_m = std::min(shallowest_m, world.depth_m);
      result.baseline = std::max(result.baseline, 1e3 * std::abs(world.depth_m - rest.depth_m));
      result.ours = std::max(result.ours, 1e3 * std::abs(ours.depth_m - rest.depth_m));
      if (result.plot.series.empty()) {
        world.series.name = "limit in the world";
        ours.series.name = "ours";
        ours.series.ours = true;
        rest.series.name = "bone at rest";
        result.plot = {.x_label = "time [s]",
                       .y_label = "depth of the hole [mm]",
                       .series = {world.series, rest.series, ours.series}};
      }
    }
    complete = complete && setting.GoesOn(law == control::Law::kAdmittance ? 0.5 : 1.0);
  }
  result.baseline_fails = result.baseline > 5.0 * result.bound;
  result.ours_passes = complete && all_stopped && !fault && result.ours <= result.bound;
  result.note = fmt::format(
      "bone at rest: {:.3f} mm; on its mount the limit in the world stops at {:.3f} mm; both laws, elastic "
      "and with pads that creep{}{}",
      1e3 * rest_m, 1e3 * shallowest_m, all_stopped ? "" : "; a spindle was never stopped",
      fault ? "; a fault ended a trial" : "");
  return result;
}

}  // namespace osteon::studies
