#include "studies/failures/cutting/fast_rotation.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "simulation/methods/method.h"
#include "studies/failures/scenario_bench.h"

namespace osteon::studies {
namespace {

constexpr double kRadius_m = 2e-3, kStall_s = 0.1;  // radius of the ball; length of the frame

// The pose of the tool, turned about z through its origin (the pivot).
Pose RotatedPose(double angle_rad) {
  Pose X = Pose::Identity();
  X.linear() = ExpRotation(Vector3(0, 0, angle_rad));
  return X;
}

// Deepest overlap of the tool's ball with a ball of the bone [m]; 0 if there is none.
double Overlap(const simulation::Bone& bone, const Vector3& center_m) {
  double deepest_m = 0.0;
  for (const simulation::Ball& ball : bone.balls)
    deepest_m = std::max(deepest_m, kRadius_m + ball.radius_m - (center_m - Vector3(ball.center_m)).norm());
  return deepest_m;
}

// Penetration of the tool's ball into the post in one turn.
struct TurnPenetration {
  double arc_m{
      0.0};  ///< deepest true penetration on the path up to the first contact that the engine reports
  double end_m{0.0};  ///< penetration of the proxy at the end
};

/// Turns the tool by `angle` in one frame.
TurnPenetration RotateInto(simulation::CuttingEngine& engine, const simulation::Bone& bone, double lever_m,
                           double angle_rad) {
  engine.Step(FrameAt(RotatedPose(0.0)));
  const auto model = engine.Step(FrameAt(RotatedPose(angle_rad), 0.0, kStall_s));
  const Vector3 ball_T(lever_m, 0, 0);
  TurnPenetration penetration{.end_m = Overlap(bone, Pose(model.X_WP) * ball_T)};
  constexpr int kSamples = 2000;  // about 0.04 mm apart: the overlap of two balls there errs by less than 1
                                  // um
  for (int i = 0; i <= kSamples; ++i)
    penetration.arc_m =
        std::max(penetration.arc_m,
                 Overlap(bone, RotatedPose(model.contact_fraction * angle_rad * i / kSamples) * ball_T));
  return penetration;
}

}  // namespace

FailureResult RunFastRotation(const FailureSetting& setting) {
  FailureResult result{.id = 11,
                       .name = "fast rotation",
                       .metric = "penetration on the true arc beyond L θ²/8 of a millisecond",
                       .unit = "mm",
                       .baseline_name = "straight chord (the paper's method, corrected)",
                       .bound = 0.010};
  const std::vector<double> speeds_deg_per_s =
      setting.full() ? std::vector{135.0, 180.0, 240.0, 300.0, 360.0} : std::vector{135.0, 360.0};
  const std::vector<double> levers_m =
      setting.full() ? std::vector{0.06, 0.08, 0.1, 0.12, 0.15} : std::vector{0.06, 0.15};
  FailureSeries theirs{.name = "straight chord", .x = {}, .y = {}},
      mine{.name = "ours", .x = {}, .y = {}, .ours = true};
  std::vector<std::array<double, 3>> points;  // sagitta, baseline, ours; mm
  bool complete = true;
  double end_m = 0.0;
  int done = 0;
  for (const double lever_m : levers_m)
    for (const double speed : speeds_deg_per_s) {
      if (!complete) break;
      const double rate_rad_per_s = speed * M_PI / 180.0, angle = rate_rad_per_s * kStall_s;
      const double sagitta_m = lever_m * (1.0 - std::cos(0.5 * angle));
      const double turn_rad = rate_rad_per_s * 1e-3;  // the turn in a frame of 1 ms, if there were no stall
      const double allowed_m = lever_m * turn_rad * turn_rad / 8.0;
      // the post, built on the x axis and rotated to the middle of the arc
      simulation::Bone post = MakeBlock({.low_m = {lever_m + kRadius_m - 0.5 * sagitta_m, -1.5e-3, -2e-3},
                                         .high_m = {lever_m + kRadius_m + 3e-3, 1.5e-3, 2e-3},
                                         .ball_radius_m = 0.4e-3});
      for (simulation::Ball& ball : post.balls)
        ball.center_m = Vector3(RotatedPose(0.5 * angle) * Vector3(ball.center_m));
      simulation::Tool tool = MakeBallTool(kRadius_m);
      tool.balls[0].center_m = Vector3(lever_m, 0, 0);
      const auto ours = setting.make_engine(post, tool, Pose::Identity(), {});
      const auto chord = simulation::MakeMethod(simulation::Method::kPaperCorrected, post, nullptr, tool,
                                                Pose::Identity(), {}, {});
      const TurnPenetration our_entry = RotateInto(*ours, post, lever_m, angle);
      const double our_mm = 1e3 * (our_entry.arc_m - allowed_m);
      const double their_mm = 1e3 * (RotateInto(*chord, post, lever_m, angle).arc_m - allowed_m);
      end_m = std::max(end_m, our_entry.end_m);
      result.ours = std::max(result.ours, our_mm);
      result.baseline = std::max(result.baseline, their_mm);
      points.push_back({1e3 * sagitta_m, their_mm, our_mm});
      ++done;
      complete = setting.GoesOn(static_cast<double>(done) /
                                static_cast<double>(levers_m.size() * speeds_deg_per_s.size()));
    }
  std::ranges::sort(points);
  for (const auto& [sagitta, baseline, our] : points) {
    theirs.x.push_back(sagitta);
    theirs.y.push_back(baseline);
    mine.x.push_back(sagitta);
    mine.y.push_back(our);
  }
  result.baseline_fails = result.baseline > result.bound;
  result.ours_passes = complete && result.ours <= result.bound;
  result.note =
      fmt::format("{} turns after a stall of 100 ms; after sliding the ball overlaps by {:.3f} mm at most",
                  done, 1e3 * end_m);
  result.plot = {.x_label = "height of the arc over its chord [mm]",
                 .y_label = "penetration [mm]",
                 .series = {std::move(theirs), std::move(mine)},
                 .bound_is_on_y = true};
  return result;
}

}  // namespace osteon::studies
