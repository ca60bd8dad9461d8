#include "studies/failures/compliance/depth_on_mount.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "control/compliance/compliance.h"
#include "safety/depth_limit.h"
#include "studies/failures/compliance/carrier.h"
#include "studies/failures/scenario_bench.h"

namespace osteon::studies {
namespace {

constexpr double kTick_s = 1e-3, kPush_N = 120.0, kPushRise_s = 1.0;
constexpr double kPlanned_m = 2e-3;      // depth of the hole
constexpr double kSpindleStop_m = 1e-3;  // the spindle stops that far before the bound
constexpr double kSoft_m = 3e-3, kLimit_N_per_m = 20e3;
constexpr int kMaxTicks = 20'000, kAfter = 300;  // ticks; observed after the spindle stopped

constexpr std::array kCarriers{Carrier{.mass_kg = 3.0, .damping_Ns_per_m = 100.0},
                               Carrier{.mass_kg = 6.0, .damping_Ns_per_m = 150.0}};

struct Course {
  double depth_m{0.0};  ///< of the hole
  bool stopped{false};  ///< the limit has stopped the spindle
  FailureSeries series;
};

Course Ream(const FailureSetting& setting, const simulation::Bone& bone, Carrier carrier,
            const std::optional<control::BoneMountParams>& mount, bool rides_on_bone) {
  const simulation::CuttingParams cutting;
  const auto engine = setting.make_engine(bone, MakeBallTool(5e-3), Pose::Identity(), cutting);
  control::Compliance compliance({.mount = mount}, kTick_s);
  // A pressed tool is ahead of its proxy: by the push, less the limit's resistance where the spindle stops.
  const double ahead_m = (kPush_N - kLimit_N_per_m * (kSoft_m - kSpindleStop_m)) / cutting.stiffness_N_per_m;
  safety::DepthLimit limit({.acts = true,
                            .bound = {.shape = safety::ZoneShape::kHalfSpace,
                                      .p_W_m = {0.0, 0.0, -kPlanned_m - ahead_m - kSpindleStop_m}},
                            .soft_m = kSoft_m,
                            .spindle_stop_m = kSpindleStop_m,
                            .stiffness_N_per_m = kLimit_N_per_m,
                            .rides_on_bone = rides_on_bone});
  Course course;
  carrier.way_m = 0.05e-3;  // upwards, of the apex over the bone
  int since_stop = 0;
  for (int i = 0; i < kMaxTicks && since_stop < kAfter; ++i) {
    const Pose X_WT = Downwards({0, 0, carrier.way_m});
    const Vector3 v_WT(0.0, 0.0, carrier.v_m_per_s);
    const Pose X_MT = compliance.X_ME(X_WT);
    const Twist V_MT = compliance.V_ME(X_WT, {.v = v_WT});
    const double spindle = limit.stops_spindle() ? 0.0 : kScenarioSpindle_rad_per_s;
    const simulation::ContactModel model = engine->Step(FrameAt(X_MT, spindle, kTick_s));
    const Wrench F_T_M = Wrench(model.F_T_W);
    const Vector3 f_limit_N =
        rides_on_bone ? limit.Step(X_MT.translation(), V_MT.v) : limit.Step(X_WT.translation(), v_WT);
    compliance.Step(F_T_M, model, X_WT);
    const double force_N = compliance.OnTool(F_T_M, X_WT).f.z() + f_limit_N.z();
    carrier.Step(force_N - RisingPush(kPush_N, kTick_s * i, kPushRise_s), kTick_s);
    course.depth_m = std::max(course.depth_m, -Pose(model.X_WP).translation().z());
    course.stopped = limit.stops_spindle();
    if (course.stopped) ++since_stop;
    if (i % 10 == 0) {
      course.series.x.push_back(kTick_s * i);
      course.series.y.push_back(1e3 * course.depth_m);
    }
  }
  return course;
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
  bool complete = true, all_stopped = true;
  double shallowest_m = 1.0, rest_m = 0.0;
  for (std::size_t law = 0; law < kCarriers.size(); ++law) {
    Course rest = Ream(setting, bone, kCarriers[law], {}, false);
    rest_m = rest.depth_m;
    all_stopped = all_stopped && rest.stopped;
    for (const control::BoneMountParams& mount : {elastic, creeping}) {
      Course world = Ream(setting, bone, kCarriers[law], mount, false);
      Course ours = Ream(setting, bone, kCarriers[law], mount, true);
      all_stopped = all_stopped && world.stopped && ours.stopped;
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
    complete = complete && setting.GoesOn(static_cast<double>(law + 1) / kCarriers.size());
  }
  result.baseline_fails = result.baseline > 5.0 * result.bound;
  result.ours_passes = complete && all_stopped && result.ours <= result.bound;
  result.note = fmt::format(
      "bone at rest: {:.3f} mm; on its mount the limit in the world stops at {:.3f} mm; both laws, elastic "
      "and with pads that creep{}",
      1e3 * rest_m, 1e3 * shallowest_m, all_stopped ? "" : "; a spindle was never stopped");
  return result;
}

}  // namespace osteon::studies
