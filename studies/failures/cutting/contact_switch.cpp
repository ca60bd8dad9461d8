#include "studies/failures/cutting/contact_switch.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "studies/failures/contact_bench.h"
#include "studies/failures/scenario_bench.h"

namespace osteon::studies {
namespace {

// Radius of the tool's two balls, half their distance, and amplitude and frequency of their motion up and
// down.
constexpr double kRadius_m = 3e-3, kHalfApart_m = 5e-3, kRock_m = 0.1e-3, kRock_hz = 2.0;
constexpr double kForce_N = 200.0, kStiffness_N_per_m = 20e3, kDt_s = 1e-3;

// The tool's pose while it rocks about the midpoint between its balls. It is pressed down to 200 N within the
// first `landing` frames.
Pose RockingPose(int frame, int landing) {
  const double press = std::min(1.0, static_cast<double>(frame) / landing);
  const double t = std::max(0, frame - landing) * kDt_s;
  const double angle = kRock_m / kHalfApart_m * std::sin(2.0 * std::numbers::pi * kRock_hz * t);
  const Vector3 turn(0.0, angle, 0.0);
  const Vector3 middle(0.2e-3, 0.1e-3, kRadius_m + 0.1e-3 - press * (kForce_N / kStiffness_N_per_m + 0.1e-3));
  return Down(middle + Down(Vector3::Zero(), turn).linear() * Vector3(0, 0, kRadius_m), turn);
}

}  // namespace

FailureResult RunContactSwitch(const FailureSetting& setting) {
  FailureResult result{.id = 2,
                       .name = "contact switch",
                       .metric = "largest change of the torque in a millisecond",
                       .unit = "N·m",
                       .baseline_name = "force and torque of the pair that was met (equations 1 and 2)",
                       .bound = 0.05};
  const simulation::Bone bone = WithFriction(
      MakeBlock({.low_m = Vector3(-12e-3, -5e-3, -2e-3), .high_m = Vector3(12e-3, 5e-3, 0)}), 0.0);
  simulation::Tool tool;
  tool.name = "two balls";
  for (const double side : {-1.0, 1.0})
    tool.balls.push_back({.center_m = Vector3(side * kHalfApart_m, 0, -kRadius_m), .radius_m = kRadius_m});

  const auto engine = setting.make_engine(bone, tool, Pose::Identity(), {});
  SingleContact baseline(bone.balls, tool, {.stiffness_N_per_m = kStiffness_N_per_m});
  // numbers of frames: pressing down; from kSettled on the frames are judged
  constexpr int kLanding = 50, kSettled = 100;
  const int frames = kSettled + (setting.full() ? 2000 : 500);
  FailureSeries of_ours{.name = "ours", .ours = true}, of_baseline{.name = "one pair"};
  std::vector<double> forces;
  bool complete = true;
  for (int i = 0; i < frames && complete; ++i) {
    const Pose X_WT = RockingPose(i, kLanding);
    const simulation::ContactModel model = engine->Step(FrameAt(X_WT, 0.0, kDt_s));
    const SingleContactFrame one = baseline.Step(X_WT);
    if (i < kSettled) continue;
    const double t_ms = (i - kSettled) * kDt_s * 1e3;
    of_ours.x.push_back(t_ms);
    of_ours.y.push_back(Vector3(model.F_T_W.t).y());
    of_baseline.x.push_back(t_ms);
    of_baseline.y.push_back(one.F_T_G.t.y());
    forces.push_back(Vector3(model.F_T_W.f).norm());
    if (i % 64 == 0) complete = setting.GoesOn(static_cast<double>(i) / frames);
  }
  result.ours = LargestStep(of_ours.y);
  result.baseline = LargestStep(of_baseline.y);
  const double force_step = forces.empty() ? 1.0 : LargestStep(forces) / kForce_N;
  result.baseline_fails = result.baseline > result.bound;
  result.ours_passes = complete && result.ours < result.bound && force_step < 0.07;
  result.note =
      fmt::format("the force changes by {:.2f} % in a millisecond at most; the torque swings to {:.2f} N·m",
                  100.0 * force_step, Largest(of_ours.y));
  result.plot = {.x_label = "time [ms]",
                 .y_label = "torque about the rocking axis [N·m]",
                 .series = {of_baseline, of_ours}};
  return result;
}

}  // namespace osteon::studies
