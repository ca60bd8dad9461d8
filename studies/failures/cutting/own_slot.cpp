#include "studies/failures/cutting/own_slot.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "studies/failures/contact_bench.h"
#include "studies/failures/scenario_bench.h"

namespace osteon::studies {
namespace {

constexpr double kHead_m = 2e-3, kShaft_m = 1.85e-3;  // radii
constexpr double kDepth_m = 4e-3;                     // depth of the slot
constexpr double kTilt_rad = 0.22;

// The tool's pose at the slot's end, tilted about its head's centre, and raised by up_m.
Pose Tilted(double tilt_rad, double up_m) {
  const Vector3 turn(tilt_rad, 0.5 * tilt_rad, 0.0), head(3e-3, 0, kHead_m - kDepth_m);
  return Down(head + Vector3(0, 0, up_m) + Down(Vector3::Zero(), turn).linear() * Vector3(0, 0, kHead_m),
              turn);
}

}  // namespace

FailureResult RunOwnSlot(const FailureSetting& setting) {
  FailureResult result{.id = 5,
                       .name = "own slot",
                       .metric = "deepest overlap of the proxy with bone",
                       .unit = "mm",
                       .baseline_name = "positive roots only",
                       .bound = 0.05};
  const simulation::Bone bone = MakeBlock({.low_m = Vector3(-7e-3, -5e-3, -6e-3),
                                           .high_m = Vector3(7e-3, 5e-3, 0),
                                           .point_spacing_m = setting.full() ? 0.5e-3 : 1e-3});
  const simulation::Tool tool = simulation::MakeReamer(kHead_m, kShaft_m, 10e-3, 0.9, Vector3::Zero());
  simulation::CuttingParams params;
  params.law = simulation::RemovalLaw::kImmediate;
  const auto engine = setting.make_engine(bone, tool, Pose::Identity(), params);

  // Cut the slot: 6 mm long, 4 mm deep, in layers of 1 mm back and forth.
  const int steps = setting.full() ? 200 : 60;
  engine->Step(FrameAt(Down({-3e-3, 0, 0.1e-3}), kScenarioSpindle_rad_per_s));
  for (int pass = 1; pass <= 5; ++pass)
    for (int i = 0; i <= steps; ++i) {
      const double x = (pass % 2 == 0 ? -1.0 : 1.0) * (-3e-3 + 6e-3 * i / steps);
      engine->Step(FrameAt(Down({x, 0, -kDepth_m / 4.0 * std::min(pass, 4)}), kScenarioSpindle_rad_per_s));
    }
  const std::vector<simulation::Ball> balls = BallsLeft(engine->Snapshot());

  // Tilt the tool against the walls, press it down and sideways, then draw it out. The baseline does the same
  // in the same carved slot.
  SingleContact baseline(balls, tool, {.positive_roots_only = true, .slides = 3});
  FailureSeries of_ours{.name = "ours", .ours = true}, of_baseline{.name = "positive roots only"};
  double lag_m = 0.0;
  bool complete = true;
  constexpr int kTilting = 60, kPressing = 80, kLeaving = 160;
  for (int i = 0; i <= kTilting + kPressing + kLeaving && complete; ++i) {
    const double tilt = kTilt_rad * std::min(1.0, static_cast<double>(i) / kTilting);
    const double pressed = std::clamp(static_cast<double>(i - kTilting) / 40.0, 0.0, 1.0);
    const double leaving = std::max(0, i - kTilting - kPressing) / static_cast<double>(kLeaving);
    Pose X_WT = Tilted(tilt, 10e-3 * leaving);
    if (leaving == 0.0) X_WT.translation() += pressed * Vector3(0, 1.5e-3, -1.5e-3);
    const simulation::ContactModel model = engine->Step(FrameAt(X_WT));
    Pose X_baseline = X_WT;
    X_baseline.translation() = baseline.Step(X_WT).p_G;
    of_ours.x.push_back(i);
    of_ours.y.push_back(1e3 * DeepestOverlap(balls, tool, model.X_WP));
    of_baseline.x.push_back(i);
    of_baseline.y.push_back(1e3 * DeepestOverlap(balls, tool, X_baseline));
    if (leaving > 0.5) lag_m = std::max(lag_m, (Pose(model.X_WP).translation() - X_WT.translation()).norm());
    if (i % 16 == 0) complete = setting.GoesOn(static_cast<double>(i) / (kTilting + kPressing + kLeaving));
  }
  result.ours = Largest(of_ours.y);
  result.baseline = Largest(of_baseline.y);
  result.baseline_fails = result.baseline > result.bound;
  // the tool has come out of the slot if the proxy follows the hand
  result.ours_passes = complete && result.ours < result.bound && lag_m < 0.1e-3;
  result.note = fmt::format("above the slot the proxy is off the tool by {:.3f} mm at most", 1e3 * lag_m);
  result.plot = {
      .x_label = "frame", .y_label = "overlap [mm]", .series = {of_baseline, of_ours}, .bound_is_on_y = true};
  return result;
}

}  // namespace osteon::studies
