#include "studies/failures/loop/cogging.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "simulation/packing/packing_builder.h"
#include "simulation/solids/box_solid.h"
#include "studies/failures/contact_bench.h"
#include "studies/failures/scenario_bench.h"

namespace osteon::studies {
namespace {

// Radius of the tool's head, radius of its balls, and the force with which the head is pressed.
constexpr double kHead_m = 5e-3, kPart_m = 1e-3, kForce_N = 100.0, kStiffness_N_per_m = 20e3;
constexpr double kSpeed_m_per_s = 0.05, kDt_s = 1e-3;

// A head of many equal balls that touch its sphere from inside, arranged on a golden spiral about the feed.
// Its apex is T's origin.
simulation::Tool PackedHead() {
  simulation::Tool tool;
  tool.name = "packed head";
  constexpr int kBalls = 160;
  const double golden_angle_rad = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < kBalls; ++i) {
    const double z = 1.0 - (i + 0.5) / kBalls;  // only the front half of the head
    const double s = std::sqrt(1.0 - z * z);
    const Vector3 out(s * std::cos(golden_angle_rad * i), s * std::sin(golden_angle_rad * i), z);
    tool.balls.push_back(
        {.center_m = Vector3(0, 0, -kHead_m) + (kHead_m - kPart_m) * out, .radius_m = kPart_m});
  }
  return tool;
}

}  // namespace

FailureResult RunCogging(const FailureSetting& setting) {
  FailureResult result{.id = 7,
                       .name = "cogging",
                       .metric = "largest tangential force over the normal force",
                       .unit = "%",
                       .baseline_name = "packed head, the plane of the pair that was met",
                       .bound = 7.0};
  simulation::Bone bone = WithFriction(
      MakeBlock({.low_m = Vector3(-1.5e-3, -1e-3, -2e-3), .high_m = Vector3(1.5e-3, 1e-3, 0)}), 0.0);
  const double length_m = setting.full() ? 20e-3 : 6e-3;
  const simulation::BoxSolid plate(Vector3(-0.5 * length_m - 3e-3, -3.5e-3, -2.5e-3),
                                   Vector3(0.5 * length_m + 3e-3, 3.5e-3, 0));
  bone.balls = simulation::BuildPacking(plate, simulation::EverywhereZone(), {});
  bone.points.clear();
  const simulation::Tool tool = PackedHead();
  const auto engine = setting.make_engine(bone, tool, Pose::Identity(), {});
  SingleContact baseline(bone.balls, tool, {.stiffness_N_per_m = kStiffness_N_per_m, .slides = 3});

  FailureSeries of_ours{.name = "ours", .ours = true}, of_baseline{.name = "one pair"};
  double normal_sum_N = 0.0, baseline_normal_sum_N = 0.0;
  constexpr int kLanding = 40;
  const int frames = kLanding + static_cast<int>(length_m / kSpeed_m_per_s / kDt_s);
  bool complete = true;
  for (int i = 0; i < frames && complete; ++i) {
    const double x = -0.5 * length_m + kSpeed_m_per_s * kDt_s * std::max(0, i - kLanding);
    const double z = 0.2e-3 - (kForce_N / kStiffness_N_per_m + 0.2e-3) * std::min(1.0, 2.0 * i / kLanding);
    const Pose X_WT = Downwards({x, 0.15 * x, z});
    const Vector3 f = engine->Step(FrameAt(X_WT, 0.0, kDt_s)).F_T_W.f;
    const Vector3 one = baseline.Step(X_WT).F_T_G.f;
    if (i % 16 == 0) complete = setting.GoesOn(static_cast<double>(i) / frames);
    if (i <= kLanding) continue;
    normal_sum_N += f.z();
    baseline_normal_sum_N += one.z();
    of_ours.x.push_back(1e3 * x);
    of_ours.y.push_back(f.head<2>().norm());
    of_baseline.x.push_back(1e3 * x);
    of_baseline.y.push_back(one.head<2>().norm());
  }
  // Converts tangential forces to percent of the mean normal force; returns the largest percentage.
  const auto in_percent = [](FailureSeries& series, double sum_N) {
    const double mean_N = sum_N / static_cast<double>(series.y.size());
    for (double& value : series.y) value *= 100.0 / mean_N;
    return Largest(series.y);
  };
  result.ours = in_percent(of_ours, normal_sum_N);
  result.baseline = in_percent(of_baseline, baseline_normal_sum_N);
  result.baseline_fails = result.baseline > result.bound;
  result.ours_passes = complete && result.ours < result.bound;
  result.note =
      fmt::format("mean normal force {:.1f} N", normal_sum_N / static_cast<double>(of_ours.y.size()));
  result.plot = {.x_label = "way [mm]",
                 .y_label = "tangential over normal force [%]",
                 .series = {of_baseline, of_ours},
                 .bound_is_on_y = true};
  return result;
}

}  // namespace osteon::studies
