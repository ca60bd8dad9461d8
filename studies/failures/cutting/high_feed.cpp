#include "studies/failures/cutting/high_feed.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "simulation/methods/method.h"
#include "simulation/tools/swept_tool.h"
#include "studies/failures/scenario_bench.h"

namespace osteon::studies {
namespace {

constexpr double kLength_m = 24e-3;    // length of the block along x
constexpr double kMinDrawn_mm = 1e-7;  // smaller values, and zero, are drawn as this value

/// The radius of a tool, its feed, and the rate of frames.
struct Case {
  double radius_m, speed_m_per_s, rate_hz;
};

/// Position of the apex at a share (0 … 1) of the path: in from one side, along a wave, out at the other
/// side.
Vector3 OnSlot(double share, double R) {
  const double x = (share - 0.5) * (kLength_m + 6.0 * R);
  return {x, 0.5 * R * std::sin(2.0 * M_PI * x / (0.5 * kLength_m)), -R};
}

/// Appends the proxy's path in a frame, as the engine reports it: to first contact, along the surface, into
/// the bone.
void AddPath(const simulation::ContactModel& model, const Pose& X_WT, std::vector<Pose>& path) {
  const Vector3 from = path.back().translation();
  const auto at = [&](const Vector3& p) {
    Pose X = X_WT;
    X.translation() = p;
    path.push_back(X);
  };
  at(from + model.contact_fraction * (X_WT.translation() - from));
  at(model.p_WS_m);
  at(Pose(model.X_WP).translation());
}

/// Judged results of milling one slot.
struct Outcome {
  double residue_m{0.0};  ///< how deep the remaining balls reach into the sweep
  double behind_m{0.0};   ///< largest distance of the proxy from the hand at the end of a frame
};

/// Mills the slot, and measures how deep the remaining balls reach into the volume that the proxy swept.
/// @param has_path  the engine reports the proxy's path in a frame; false: only its pose at the end
Outcome Mill(simulation::CuttingEngine& engine, const simulation::Tool& tool, const Case& c, bool has_path) {
  const double R = c.radius_m;
  double length_m = 0.0;
  for (int i = 0; i < 1000; ++i) length_m += (OnSlot(1e-3 * (i + 1), R) - OnSlot(1e-3 * i, R)).norm();
  const int frames = std::max(2, static_cast<int>(std::ceil(length_m / (c.speed_m_per_s / c.rate_hz))));
  std::vector<Pose> path;
  Outcome outcome;
  for (int i = 0; i <= frames; ++i) {
    const Pose X_WT = Downwards(OnSlot(static_cast<double>(i) / frames, R));
    const auto model = engine.Step(FrameAt(X_WT, kScenarioSpindle_rad_per_s, 1.0 / c.rate_hz));
    if (path.empty() || !has_path)
      path.push_back(model.X_WP);
    else
      AddPath(model, X_WT, path);
    outcome.behind_m =
        std::max(outcome.behind_m, (Pose(model.X_WP).translation() - X_WT.translation()).norm());
  }
  const simulation::SweptTool swept(tool, path, 1e-9);
  for (const simulation::Ball& ball : BallsLeft(engine.Snapshot()))
    outcome.residue_m = std::max(outcome.residue_m, ball.radius_m - swept.SignedDistance(ball.center_m));
  return outcome;
}

}  // namespace

FailureResult RunHighFeed(const FailureSetting& setting) {
  FailureResult result{.id = 9,
                       .name = "high feed",
                       .metric = "depth of what is left inside the cutting surface's path",
                       .unit = "mm",
                       .baseline_name = "stamps at discrete poses",
                       .bound = 0.001};
  std::vector<Case> cases;
  if (setting.full()) {
    for (const double R : {0.5e-3, 1e-3, 2e-3, 5e-3})
      for (const double speed : {0.05, 0.2, 1.0})
        for (const double rate : {60.0, 250.0, 1000.0})
          cases.push_back({.radius_m = R, .speed_m_per_s = speed, .rate_hz = rate});
  } else {
    cases = {{1e-3, 0.2, 60.0}, {1e-3, 1.0, 250.0}, {5e-3, 1.0, 1000.0}};
  }
  const simulation::CuttingParams params{.law = simulation::RemovalLaw::kImmediate};
  FailureSeries baseline_points{.name = "stamps", .x = {}, .y = {}},
      our_points{.name = "ours", .x = {}, .y = {}, .ours = true};
  // step of a frame divided by the tool's radius, error of the baseline, error of ours
  std::vector<std::array<double, 3>> points;
  double behind_m = 0.0;
  bool complete = true;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& c = cases[i];
    const double R = c.radius_m, half_width_m = 2.0 * R + 0.5e-3;
    const simulation::Bone block = MakeBlock({.low_m = {-0.5 * kLength_m, -half_width_m, -1.6 * R},
                                              .high_m = {0.5 * kLength_m, half_width_m, 0.0},
                                              .ball_radius_m = std::clamp(0.4 * R, 0.25e-3, 0.75e-3),
                                              .point_spacing_m = std::max(0.3 * R, 0.5e-3)});
    const simulation::Tool tool = MakeBallTool(R);
    const auto ours = setting.make_engine(block, tool, Pose::Identity(), params);
    const auto stamps = simulation::MakeMethod(simulation::Method::kStamps, block, nullptr, tool,
                                               Pose::Identity(), params, {});
    const Outcome mine = Mill(*ours, tool, c, true), theirs = Mill(*stamps, tool, c, false);
    result.ours = std::max(result.ours, 1e3 * mine.residue_m);
    result.baseline = std::max(result.baseline, 1e3 * theirs.residue_m);
    behind_m = std::max(behind_m, mine.behind_m);
    points.push_back({c.speed_m_per_s / c.rate_hz / R, 1e3 * theirs.residue_m, 1e3 * mine.residue_m});
    complete = setting.GoesOn(static_cast<double>(i + 1) / static_cast<double>(cases.size())) && complete;
    if (!complete) break;
  }
  std::ranges::sort(points);
  for (const auto& [step, theirs, mine] : points) {
    baseline_points.x.push_back(step);
    baseline_points.y.push_back(std::max(kMinDrawn_mm, theirs));
    our_points.x.push_back(step);
    our_points.y.push_back(std::max(kMinDrawn_mm, mine));
  }
  result.baseline_fails = result.baseline > result.bound;
  // Every frame must also end at the hand: a law that cuts nothing would have no path, and so no residue.
  result.ours_passes = complete && result.ours <= result.bound && 1e3 * behind_m <= result.bound;
  result.note = fmt::format("{} feeds; the proxy ends every frame within {:.1e} mm of the hand",
                            points.size(), 1e3 * behind_m);
  result.plot = {.x_label = "way in a frame over the tool's radius",
                 .y_label = "depth left in the path [mm]",
                 .log_x = true,
                 .log_y = true,
                 .series = {std::move(baseline_points), std::move(our_points)},
                 .bound_is_on_y = true};
  return result;
}

}  // namespace osteon::studies
