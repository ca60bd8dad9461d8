#include "studies/failures/cutting/concave_cup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "simulation/bone/scenes.h"
#include "studies/failures/contact_bench.h"
#include "studies/failures/scenario_bench.h"

namespace osteon::studies {
namespace {

// Radius of the cup, depth to which the reamer is pressed in, and its speed along the wall.
constexpr double kCup_m = 25e-3, kDepth_m = 5e-3, kSpeed_deg_per_s = 50.0, kDt_s = 1e-3;
constexpr int kLanding = 40;  // frames in which the tool is pressed into the cup; they are not judged

// Error of one method's normal along the path, and the normal's largest change from one frame to the next.
struct NormalErrors {
  double worst_deg{0.0}, jump_deg{0.0};
  std::vector<double> angle_deg, error_deg;
  Vector3 before{Vector3::Zero()};

  // Adds one frame.
  // @param angle  between the cup's axis and the direction to the contact [deg]
  // @param out    direction from the cup's centre to the contact
  // @param f      force or normal, of any length
  void Add(int i, double angle, const Vector3& out, const Vector3& f) {
    const double error = AngleDeg(f, -out);
    if (i > kLanding) {
      worst_deg = std::max(worst_deg, error);
      jump_deg = std::max(jump_deg, AngleDeg(f, before));
      angle_deg.push_back(angle);
      error_deg.push_back(error);
    }
    before = f;
  }
};

}  // namespace

FailureResult RunConcaveCup(const FailureSetting& setting) {
  FailureResult result{.id = 3,
                       .name = "concave cup",
                       .metric = "largest error of the normal",
                       .unit = "deg",
                       .baseline_name = "the plane of the pair that was met",
                       .bound = 1.0};
  simulation::AcetabulumParams cup;
  cup.shape.width_m = 56e-3;
  cup.shape.height_m = 30e-3;
  cup.shape.cup_radius_m = kCup_m;
  // Only the contact is judged, not the mass: coarse mass points suffice.
  cup.points.cells = {.finest_m = 3e-3, .coarser_from_m = {}};
  if (!setting.full()) cup.packing.surface_gap_m = 0.1e-3;
  const simulation::Bone bone = WithFriction(simulation::MakeAcetabulum(cup), 0.0);

  constexpr std::array kHeads_m{24e-3, 24.98e-3};
  constexpr std::array<const char*, 2> kNames{"24 mm", "24.98 mm"};
  const int frames = static_cast<int>((setting.full() ? 45.0 : 20.0) / kSpeed_deg_per_s / kDt_s);
  double jump = 0.0, baseline_jump = 0.0;
  bool complete = true;
  for (std::size_t h = 0; h < kHeads_m.size(); ++h) {
    const double R = kHeads_m[h];
    const simulation::Tool tool = MakeBallTool(R);
    const auto engine = setting.make_engine(bone, tool, Pose::Identity(), {});
    SingleContact baseline(bone.balls, tool, {.slides = 3});
    engine->Step(FrameAt(Downwards({0, 0, -R})));
    baseline.Step(Downwards({0, 0, -R}));
    NormalErrors ours, one;
    const int count = frames + kLanding;
    for (int i = 1; i <= count && complete; ++i) {
      const double angle = kSpeed_deg_per_s * kDt_s * std::max(0, i - kLanding) +
                           // angle at which the packing of the wall has the largest effect
                           (setting.full() ? 0.0 : 25.0);
      const double a = angle * std::numbers::pi / 180.0;
      const Vector3 out(0.8 * std::sin(a), 0.6 * std::sin(a), -std::cos(a));
      const double offset = kCup_m - R + kDepth_m * std::min(1.0, 2.0 * i / kLanding);
      const Pose X_WT = Downwards(offset * out - Vector3(0, 0, R));
      ours.Add(i, angle, out, engine->Step(FrameAt(X_WT, 0.0, kDt_s)).F_T_W.f);
      one.Add(i, angle, out, baseline.Step(X_WT).n);
      if (i % 32 == 0)
        complete = setting.GoesOn(0.5 * (static_cast<double>(h) + static_cast<double>(i) / count));
    }
    result.ours = std::max(result.ours, ours.worst_deg);
    result.baseline = std::max(result.baseline, one.worst_deg);
    jump = std::max(jump, ours.jump_deg);
    baseline_jump = std::max(baseline_jump, one.jump_deg);
    result.plot.series.push_back(
        {.name = fmt::format("one pair, {}", kNames[h]), .x = one.angle_deg, .y = one.error_deg});
    result.plot.series.push_back(
        {.name = fmt::format("ours, {}", kNames[h]), .x = ours.angle_deg, .y = ours.error_deg, .ours = true});
  }
  result.baseline_fails = result.baseline > result.bound;
  result.ours_passes = complete && result.ours < result.bound && jump < 0.3;
  result.note =
      fmt::format("the force turns by {:.2f} deg in a millisecond at most, the baseline's normal by {:.1f}",
                  jump, baseline_jump);
  result.plot.x_label = "contact from the cup's axis [deg]";
  result.plot.y_label = "error of the normal [deg]";
  result.plot.bound_is_on_y = true;
  return result;
}

}  // namespace osteon::studies
