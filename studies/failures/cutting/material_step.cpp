#include "studies/failures/cutting/material_step.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "studies/failures/contact_bench.h"
#include "studies/failures/scenario_bench.h"

namespace osteon::studies {
namespace {

// kDepth_m: the tool is pressed into the bone by this depth.
constexpr double kRadius_m = 3e-3, kDepth_m = 1e-3, kDt_s = 1e-3;
// numbers of frames of a cycle's phases
constexpr int kPress = 100, kTraverse = 200, kLift = 100, kBack = 100,
              kCycle = kPress + kTraverse + kLift + kBack;
// Ends of the path along x; the soft and the hard half meet at x = 0.
constexpr double kFrom_m = -3e-3, kTo_m = 3e-3;

// Position of the apex in a cycle: down on the soft half, along to the hard half, up, and back.
Vector3 HandPosition(int frame) {
  const int i = frame % kCycle;
  const double up = 0.5e-3;
  const auto smooth = [](double s) { return s * s * (3.0 - 2.0 * s); };
  if (i < kPress) return {kFrom_m, 0, up - (kDepth_m + up) * smooth(static_cast<double>(i) / kPress)};
  if (i < kPress + kTraverse)
    return {kFrom_m + (kTo_m - kFrom_m) * smooth(static_cast<double>(i - kPress) / kTraverse), 0, -kDepth_m};
  if (i < kPress + kTraverse + kLift)
    return {kTo_m, 0,
            -kDepth_m + (kDepth_m + up) * smooth(static_cast<double>(i - kPress - kTraverse) / kLift)};
  return {kTo_m + (kFrom_m - kTo_m) * smooth(static_cast<double>(i - kPress - kTraverse - kLift) / kBack), 0,
          up};
}

// Force of the baseline: a penalty force along +z whose stiffness follows the density of the nearest ball: 2
// N/mm in the soft half, 20 N/mm in the hard half.
Vector3 DensityPenalty(const simulation::Bone& bone, const Vector3& apex) {
  if (apex.z() >= 0.0) return Vector3::Zero();
  const Vector3 center = apex + Vector3(0, 0, kRadius_m);
  double nearest = std::numeric_limits<double>::infinity(), x = 0.0;
  for (const simulation::Ball& ball : bone.balls) {
    const double gap = (Vector3(ball.center_m) - center).norm() - ball.radius_m;
    if (gap >= nearest) continue;
    nearest = gap;
    x = Vector3(ball.center_m).x();
  }
  return Vector3(0, 0, (x < 0.0 ? 2e3 : 20e3) * -apex.z());
}

// Sums the work that the hand gains, by the trapezoidal rule.
class HandWork {
 public:
  void Add(const Vector3& p, const Vector3& f) {
    if (begun_) work_J_ += 0.5 * (f + f_).dot(p - p_);
    begun_ = true;
    p_ = p;
    f_ = f;
  }
  [[nodiscard]] double joules() const { return work_J_; }

 private:
  bool begun_{false};
  Vector3 p_{Vector3::Zero()}, f_{Vector3::Zero()};
  double work_J_{0.0};
};

}  // namespace

FailureResult RunMaterialStep(const FailureSetting& setting) {
  FailureResult result{.id = 18,
                       .name = "material step",
                       .metric = "work that the hand gets out of a cycle",
                       .unit = "mJ",
                       .baseline_name = "stiffness by the density of the nearest ball",
                       .bound = 0.1};
  simulation::Bone bone = WithFriction(
      MakeBlock(
          {.low_m = Vector3(-8e-3, -4e-3, -2e-3), .high_m = Vector3(8e-3, 4e-3, 0), .point_spacing_m = 1e-3}),
      0.0);
  // the half with x > 0 is cortical bone
  bone.materials.push_back(bone.materials.front());
  bone.materials.front().name = "cancellous";
  bone.materials.back().name = "cortical";
  bone.materials.back().density_kg_per_m3 *= 10.0;
  bone.materials.back().specific_cutting_energy_J_per_m3 *= 10.0;
  for (simulation::MassPoint& point : bone.points)
    point.material =
        Vector3(point.p_m).x() < 0.0 ? simulation::MaterialIndex{0} : simulation::MaterialIndex{1};

  const simulation::Tool tool = MakeBallTool(kRadius_m);
  const auto engine = setting.make_engine(bone, tool, Pose::Identity(), {});
  HandWork ours, baseline;
  FailureSeries of_ours{.name = "ours", .ours = true}, of_baseline{.name = "by density"};
  const int cycles = setting.full() ? 20 : 2;
  bool complete = true;
  double crossing_ms = 0.0;  // time at which the tool passes the border
  double last_off_ms = 0.0;  // last time at which the force differed by more than 5 % from its final value
  const double final_N = 20e3 * kDepth_m;
  for (int i = 0; i <= cycles * kCycle && complete; ++i) {
    const Vector3 p = HandPosition(i);
    const Vector3 f = engine->Step(FrameAt(Downwards(p), 0.0, kDt_s)).F_T_W.f;
    const Vector3 f_baseline = DensityPenalty(bone, p);
    ours.Add(p, f);
    baseline.Add(p, f_baseline);
    if (i >= kPress && i < kPress + kTraverse) {
      if (p.x() < 0.0) crossing_ms = i * kDt_s * 1e3;
      if (p.x() >= 0.0 && std::abs(f.norm() - final_N) > 0.05 * final_N) last_off_ms = i * kDt_s * 1e3;
    }
    if (i < kCycle) {
      of_ours.x.push_back(i * kDt_s * 1e3);
      of_ours.y.push_back(f.norm());
      of_baseline.x.push_back(i * kDt_s * 1e3);
      of_baseline.y.push_back(f_baseline.norm());
    }
    if (i % 64 == 0) complete = setting.GoesOn(static_cast<double>(i) / (cycles * kCycle));
  }
  result.ours = 1e3 * ours.joules() / cycles;
  result.baseline = 1e3 * baseline.joules() / cycles;
  const double ramp_ms = std::max(0.0, last_off_ms - crossing_ms);
  result.baseline_fails = result.baseline > result.bound;
  result.ours_passes = complete && result.ours <= result.bound && ramp_ms <= 5.0;
  result.note = fmt::format("the force settles {:.0f} ms after the border", ramp_ms);
  result.plot = {.x_label = "time [ms]", .y_label = "force [N]", .series = {of_baseline, of_ours}};
  return result;
}

}  // namespace osteon::studies
