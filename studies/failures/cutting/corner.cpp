#include "studies/failures/cutting/corner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "studies/failures/contact_bench.h"
#include "studies/failures/scenario_bench.h"

namespace osteon::studies {
namespace {

constexpr double kRadius_m = 6e-3, kStiffness_N_per_m = 20e3;
constexpr double kWall_m = -4e-3;  // x of the wall's face; the floor is z = 0

}  // namespace

FailureResult RunCorner(const FailureSetting& setting) {
  FailureResult result{.id = 4,
                       .name = "corner",
                       .metric = "largest error of the force",
                       .unit = "%",
                       .baseline_name = "first contact only",
                       .bound = 7.0};
  simulation::Bone bone = WithFriction(
      MakeBlock({.low_m = Vector3(-6e-3, -8e-3, -2e-3), .high_m = Vector3(10e-3, 8e-3, 0)}), 0.0);
  Append(MakeBlock({.low_m = Vector3(-6e-3, -8e-3, -2e-3), .high_m = Vector3(kWall_m, 8e-3, 10e-3)}), bone);
  const simulation::Tool tool = MakeBallTool(kRadius_m);
  // how far each case presses the tool into the wall and into the floor
  constexpr std::array kIntoWall_m{1e-3, 3e-3, 5e-3, 2e-3, 4e-3};
  constexpr std::array kIntoFloor_m{5e-3, 4e-3, 1e-3, 2e-3, 3e-3};
  const std::size_t cases = setting.full() ? kIntoWall_m.size() : 3;

  FailureSeries of_ours{.name = "ours", .ours = true}, of_baseline{.name = "first contact"};
  std::vector<std::array<double, 3>> points;  // angle of the push, error of ours, error of the baseline
  double wander_m = 0.0;
  bool complete = true;
  for (std::size_t c = 0; c < cases && complete; ++c) {
    const auto engine = setting.make_engine(bone, tool, Pose::Identity(), {});
    SingleContact baseline(bone.balls, tool, {.stiffness_N_per_m = kStiffness_N_per_m});
    const double y = 0.7e-3 * static_cast<double>(c);
    const Vector3 from(kWall_m + kRadius_m + 3e-3, y, 2e-3);
    const Vector3 goal(kWall_m + kRadius_m - kIntoWall_m[c], y + 0.3e-3, -kIntoFloor_m[c]);
    const Vector3 expected = kStiffness_N_per_m * Vector3(kIntoWall_m[c], 0, kIntoFloor_m[c]);
    constexpr int kMoveFrames = 60, kSettleFrames = 80, kHoldFrames = 60;
    Vector3 low = Vector3::Constant(1e9), high = -low, ours = Vector3::Zero(), one = Vector3::Zero();
    for (int i = 0; i < kMoveFrames + kSettleFrames + kHoldFrames; ++i) {
      const Pose X_WT = Down(from + std::min(1.0, static_cast<double>(i) / kMoveFrames) * (goal - from));
      const simulation::ContactModel model = engine->Step(FrameAt(X_WT));
      ours = model.F_T_W.f;
      one = baseline.Step(X_WT).F_T_G.f;
      if (i < kMoveFrames + kSettleFrames) continue;
      low = low.cwiseMin(Vector3(model.X_WP.p));
      high = high.cwiseMax(Vector3(model.X_WP.p));
    }
    wander_m = std::max(wander_m, (high - low).norm());
    points.push_back({std::atan2(expected.x(), expected.z()) * 180.0 / std::numbers::pi,
                      100.0 * (ours - expected).norm() / expected.norm(),
                      100.0 * (one - expected).norm() / expected.norm()});
    complete = setting.GoesOn(static_cast<double>(c + 1) / static_cast<double>(cases));
  }
  std::ranges::sort(points);
  for (const auto& [angle_deg, ours, one] : points) {
    of_ours.x.push_back(angle_deg);
    of_ours.y.push_back(ours);
    of_baseline.x.push_back(angle_deg);
    of_baseline.y.push_back(one);
  }
  result.ours = Largest(of_ours.y);
  result.baseline = Largest(of_baseline.y);
  result.baseline_fails = result.baseline > result.bound;
  result.ours_passes = complete && result.ours < result.bound && wander_m < 1e-6;
  result.note = fmt::format("while the tool is held, the proxy moves by {:.2g} um", 1e6 * wander_m);
  result.plot = {.x_label = "push from the floor's normal towards the wall's [deg]",
                 .y_label = "error of the force [%]",
                 .series = {of_baseline, of_ours},
                 .bound_is_on_y = true};
  return result;
}

}  // namespace osteon::studies
