#include "report_synthetic.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/tools/proxy_path.h"

namespace osteon::report {
namespace {

using simulation::Ball;

/// Distance from p to the surface of the block with its cup [m]; negative outside the bone.
double InsideBone(const Vector3& p, const SyntheticParams& params) {
  const Vector3 half = 0.5 * params.block_m;
  const double walls =
      std::min({half.x() - std::abs(p.x()), half.y() - std::abs(p.y()), -p.z(), p.z() + params.block_m.z()});
  return std::min(walls, p.norm() - params.cup_radius_m);
}

// Returns the material by the depth below the cup's surface: 0 cartilage, 1 cortical plate, 2 cancellous
// bone.
simulation::MaterialIndex MaterialAt(const Vector3& p, const SyntheticParams& params) {
  const double depth_m = p.norm() - params.cup_radius_m;
  return depth_m < 1.6e-3 ? 0 : depth_m < 2.6e-3 ? 1 : 2;
}

// Visits the points of a body-centred cubic lattice in the block, which lies below z = 0.
template <typename Visit>
void EachLatticePoint(const Vector3& block_m, double spacing_m, const Visit& visit) {
  const Vector3 half(0.5 * block_m.x(), 0.5 * block_m.y(), 0.0);
  for (double z = -block_m.z(); z <= 0.0; z += spacing_m)
    for (double y = -half.y(); y <= half.y(); y += spacing_m)
      for (double x = -half.x(); x <= half.x(); x += spacing_m) {
        visit(Vector3(x, y, z));
        visit(Vector3(x, y, z) + Vector3::Constant(0.5 * spacing_m));
      }
}

}  // namespace

void Carve(std::vector<Ball>& balls, const Vector3& a, const Vector3& b, double radius_m) {
  const Vector3 m = b - a;
  const double length2 = m.squaredNorm();
  for (Ball& ball : balls) {
    if (ball.radius_m <= 0.0) continue;
    const Vector3 c = ball.center_m;
    const double s = length2 > 0.0 ? std::clamp((c - a).dot(m) / length2, 0.0, 1.0) : 0.0;
    const Vector3 from = c - a - s * m;
    const double distance = from.norm(), p = ball.radius_m + radius_m - distance;
    if (p <= 0.0) continue;
    if (p >= 2.0 * ball.radius_m) {
      ball.radius_m = 0.0;
      continue;
    }
    ball.center_m = Vector3(c + 0.5 * p * from / distance);
    ball.radius_m -= 0.5 * p;
  }
}

simulation::CarvedState StateOf(const std::vector<Ball>& balls) {
  simulation::CarvedState state;
  for (const Ball& ball : balls) {
    for (const double value : {ball.center_m.x, ball.center_m.y, ball.center_m.z, ball.radius_m})
      state.balls.push_back(static_cast<float>(1e3 * value));
  }
  return state;
}

SyntheticRun MakeSyntheticRun(const SyntheticParams& params) {
  SyntheticRun run;
  run.cell_m = params.spacing_m;
  run.bone.name = "synthetic cup";
  run.bone.site = {.center_m = Vector3(0, 0, 0), .axis = Vector3(0, 0, 1), .radius_m = params.cup_radius_m};
  run.bone.materials = {{.name = "cartilage"}, {.name = "subchondral cortical"}, {.name = "cancellous"}};
  EachLatticePoint(params.block_m, params.spacing_m, [&](const Vector3& p) {
    const double radius_m = std::min(params.cap_m, InsideBone(p, params));
    if (radius_m > 0.2 * params.cap_m) run.bone.balls.push_back({.center_m = p, .radius_m = radius_m});
  });
  EachLatticePoint(params.block_m, params.point_spacing_m, [&](const Vector3& p) {
    if (InsideBone(p, params) > 0.0)
      run.bone.points.push_back({.p_m = p,
                                 .volume_m3 = 0.5 * std::pow(params.point_spacing_m, 3),
                                 .material = MaterialAt(p, params)});
  });
  run.tool = simulation::MakeReamer(params.tool_radius_m, 0.3 * params.tool_radius_m, 0.03, 0.9,
                                    Vector3(0.0, 0.0, -params.tool_radius_m));

  // the proxy's path: down the axis, tilted and circling, up again
  std::vector<Ball> balls = run.bone.balls;
  const double lift_m = 0.012, end_m = params.depth_m + params.cup_radius_m;
  for (int i = 0; i < params.frames; ++i) {
    const double t = static_cast<double>(i) / std::max(params.frames - 1, 1);
    const double feed = std::clamp(t / 0.5, 0.0, 1.0) - std::clamp((t - 0.85) / 0.15, 0.0, 1.0);
    const double whirl = std::clamp((t - 0.5) / 0.05, 0.0, 1.0) * std::clamp((0.85 - t) / 0.05, 0.0, 1.0);
    const double apex_m = lift_m - params.cup_radius_m - feed * (lift_m - params.cup_radius_m + end_m);
    Pose X_WP = Pose::Identity();
    const double turn = 2.0 * std::numbers::pi * 2.0 * t;
    // T's z is the feed: half a turn about x, then the tilt
    const Matrix3 R = ExpRotation(whirl * params.tilt_rad * Vector3(std::cos(turn), std::sin(turn), 0.0)) *
                      ExpRotation(Vector3(std::numbers::pi, 0, 0));
    X_WP.linear() = R;
    // tilted about a point a tool radius above the head's centre
    const Vector3 pivot(0, 0, apex_m + 2.0 * params.tool_radius_m);
    X_WP.translation() = pivot + R.col(2) * 2.0 * params.tool_radius_m;
    simulation::FrameRecord frame;
    frame.model.X_WP = X_WP;
    frame.model.frame = static_cast<std::uint64_t>(i) + 1;
    frame.stamp = static_cast<rt::Nanoseconds>(t * params.ticks * 1e6);
    frame.duration_ns = 900'000 + 200'000 * ((i * 7919) % 13) / 13 + (i % 331 == 17 ? 2'500'000 : 0);
    frame.cup_depth_m = params.depth_m * std::clamp((t - 0.4) / 0.1, 0.0, 1.0);
    frame.model.removed_volume_m3 = 2.4e-6 * std::clamp((t - 0.4) / 0.4, 0.0, 1.0);
    run.frames.push_back(frame);
  }
  const Vector3 head(0, 0, -params.tool_radius_m);
  for (std::size_t i = 0; i + 1 < run.frames.size(); i += 5) {
    const std::size_t next = std::min(i + 5, run.frames.size() - 1);
    Carve(balls, Pose(run.frames[i].model.X_WP) * head, Pose(run.frames[next].model.X_WP) * head,
          params.tool_radius_m);
  }
  run.after = StateOf(balls);

  for (int i = 0; i < params.ticks; ++i) {
    const double t_s = 1e-3 * i, share = static_cast<double>(i) / params.ticks;
    control::TickRecord tick;
    tick.tick = static_cast<std::uint64_t>(i);
    tick.stamp = 5'000'000'000 + static_cast<rt::Nanoseconds>(i) * rt::kMillisecond;
    tick.phase = share < 0.08   ? control::Phase::kWaiting
                 : share < 0.97 ? control::Phase::kHaptic
                 : share < 0.98 ? control::Phase::kStopping
                                : control::Phase::kStopped;
    const double push =
        std::clamp((share - 0.25) / 0.15, 0.0, 1.0) * std::clamp((0.85 - share) / 0.05, 0.0, 1.0);
    const double ripple = 6.0 * std::sin(40.0 * t_s) + 2.0 * std::sin(911.0 * t_s);
    const double force_N = push * (118.0 + ripple);
    Pose X_WT = Pose::Identity();
    X_WT.linear() = ExpRotation(Vector3(std::numbers::pi, 0, 0));
    tick.X_WT_cmd = tick.X_WT_meas = X_WT;
    tick.F_coupling_T_W =
        Wrench{.f = Vector3(0.1 * force_N * std::sin(4 * t_s), 0, force_N), .t = Vector3::Zero()};
    tick.F_operator_T_W = Wrench{.f = Vector3(0, 0, -push * 120.0 - 1.0), .t = Vector3::Zero()};
    tick.v_WT_cmd_m_per_s = Vector3(0.004 * push, 0, 0.02 * std::exp(-std::pow((share - 0.2) / 0.08, 2)));
    tick.model_frame = static_cast<std::uint64_t>(i / 2);
    tick.model_age_s = 1e-3 * (1.1 + 0.4 * ((i * 31) % 17) / 17.0);
    tick.wakeup_ns = 9'000 + 400 * ((i * 7919) % 41) + (i % 700 == 5 ? 180'000 : 0);
    tick.compute_ns = 21'000 + 300 * ((i * 104729) % 37) + (i % 900 == 7 ? 60'000 : 0);
    run.ticks.push_back(tick);
  }
  for (simulation::FrameRecord& frame : run.frames) frame.stamp += 5'000'000'000;
  return run;
}

std::vector<Pose> PathOf(const SyntheticRun& run, const Pose& X_WG) {
  simulation::ProxyPath path(run.tool, X_WG);
  for (const simulation::FrameRecord& frame : run.frames) path.Add(frame);
  return {path.X_GP().begin(), path.X_GP().end()};
}

}  // namespace osteon::report
