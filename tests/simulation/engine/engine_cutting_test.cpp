#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "simulation/contact/cutting_math.h"
#include "simulation/engine/frame_solution.h"
#include "tests/simulation/engine/engine_bench.h"

// Tests of cutting on every engine: the removed shape, the rate of removal, and the balance of energy. Limits
// with a row of failures.md are those of the table in docs/failures.md.

namespace osteon::simulation {
namespace {

using EngineCutting = Engine;
OSTEON_ON_EVERY_ENGINE(EngineCutting);

/// Tolerance of overlaps: float32 within 30 mm leaves up to 5.5e-6 mm, and the proxy's path is known to 4e-6
/// mm.
constexpr double kOverlap_m = 1e-8;

/// Centre and radius in metres of ball i of a state; radius 0: removed.
struct LiveBall {
  Vector3 c;
  double r;
};
LiveBall BallOf(const CarvedState& state, std::size_t i) {
  return {1e-3 * Vector3(state.balls[4 * i], state.balls[4 * i + 1], state.balls[4 * i + 2]),
          1e-3 * state.balls[4 * i + 3]};
}

/// Path of one tool ball's centre in a frame, from first contact on: it slides along the surface to `slid`,
/// then cuts to `end`.
struct SweptPath {
  Vector3 contact, slid, end;
  double radius_m;
};

/// The path in a frame without rotation, from the engine's report.
SweptPath SweptPathOf(const ToolBall& ball, const Pose& X_WP_before, const FrameInput& input,
                      const ContactModel& model) {
  const Pose X_WT = input.X_WT, X_WP = model.X_WP;
  const Vector3 before = X_WP_before * Vector3(ball.center_m), goal = X_WT * Vector3(ball.center_m);
  const Vector3 end = X_WP * Vector3(ball.center_m);
  return {.contact = before + model.contact_fraction * (goal - before),
          .slid = Vector3(model.p_WS_m) + X_WP.linear() * Vector3(ball.center_m),
          .end = end,
          .radius_m = ball.radius_m};
}

/// A removal law, a tool's radius and its feed; dt_s is a frame's duration.
struct SweepCase {
  const char* name;
  RemovalLaw law;
  double radius_m, speed_m_per_s, dt_s;
};

// failures.md row 9. In addition, each ball stays inside its old volume, and exactly the mass points inside
// the sweep are cleared.
TEST_P(EngineCutting, LeavesNothingInsideTheSweepAndNoBallGrows) {
  const Bone bone = Slab(14e-3, 4e-3, true, kSoft);
  for (const SweepCase& c : {SweepCase{"rate", RemovalLaw::kRate, 3e-3, 0.02, 1e-3},
                             SweepCase{"immediate", RemovalLaw::kImmediate, 3e-3, 0.1, 1e-3},
                             SweepCase{"high feed", RemovalLaw::kImmediate, 0.5e-3, 0.5, 4e-3},
                             SweepCase{"higher feed", RemovalLaw::kImmediate, 5e-3, 1.0, 16e-3}}) {
    CuttingParams params;
    params.law = c.law;
    Tool tool = BallTool(c.radius_m);
    tool.balls.push_back({.center_m = Vector3(1.2 * c.radius_m, 0, -c.radius_m),
                          .radius_m = 0.8 * c.radius_m,
                          .cutting = true});
    const auto engine = Make(bone, tool, params);
    const CarvedState fresh = engine->Snapshot();
    const Vector3 start(-4e-3, -1e-3, 0.3e-3), goal(4e-3, 1e-3, -2.5e-3);
    const double length_m = (goal - start).norm();
    ContactModel model = engine->Step(At(Down(start), kSpindle_rad_per_s, c.dt_s));
    std::vector<SweptPath> paths;
    const int frames = static_cast<int>(std::ceil(length_m / (c.speed_m_per_s * c.dt_s)));
    for (int i = 1; i <= frames; ++i) {
      const FrameInput input =
          At(Down(start + static_cast<double>(i) / frames * (goal - start)), kSpindle_rad_per_s, c.dt_s);
      const Pose X_WP = model.X_WP;
      model = engine->Step(input);
      ASSERT_EQ(model.status, EngineStatus::kOk);
      for (const ToolBall& ball : tool.balls) paths.push_back(SweptPathOf(ball, X_WP, input, model));
    }
    EXPECT_GT(model.removed_volume_m3, 1e-9) << c.name;
    const CarvedState carved = engine->Snapshot();
    std::size_t changed = 0;
    double worst_overlap = 0.0, worst_growth = 0.0;
    for (std::size_t i = 0; 4 * i < carved.balls.size(); ++i) {
      const LiveBall was = BallOf(fresh, i), is = BallOf(carved, i);
      if (is.r <= 0.0) continue;
      changed += is.r < was.r ? 1 : 0;
      worst_growth = std::max(worst_growth, (is.c - was.c).norm() + is.r - was.r);
      for (const SweptPath& path : paths) {
        const double closest = std::min((is.c - ClosestOnSegment(is.c, path.contact, path.slid)).norm(),
                                        (is.c - ClosestOnSegment(is.c, path.slid, path.end)).norm());
        worst_overlap = std::max(worst_overlap, path.radius_m + is.r - closest);
      }
    }
    EXPECT_GT(changed, 10u) << c.name;
    EXPECT_LE(worst_growth, kOverlap_m) << c.name;
    EXPECT_LE(worst_overlap, kOverlap_m) << c.name;

    std::size_t cleared = 0;
    for (std::size_t i = 0; i < bone.points.size(); ++i) {
      const Vector3 p = bone.points[i].p_m;
      double deepest = -1.0;  // depth of the point inside the sweep [m]; negative: outside
      for (const SweptPath& path : paths)
        deepest =
            std::max({deepest, path.radius_m - (p - ClosestOnSegment(p, path.contact, path.slid)).norm(),
                      path.radius_m - (p - ClosestOnSegment(p, path.slid, path.end)).norm()});
      cleared += carved.cleared[i];
      if (deepest > kOverlap_m) {
        ASSERT_EQ(carved.cleared[i], 1) << c.name << " " << i << " " << deepest;
      }
      if (deepest < -kOverlap_m) {
        ASSERT_EQ(carved.cleared[i], 0) << c.name << " " << i << " " << deepest;
      }
    }
    EXPECT_GT(cleared, 10u) << c.name;
  }
}

// An oblique feed, up to several times max_slide_m in a frame. The tool must still cut all of its path, and
// its advance along the contact's normal must not leave the commanded path.
TEST_P(EngineCutting, WithTheImmediateLawTheToolReachesTheCommandedPoseInEveryFrame) {
  CuttingParams params;
  params.law = RemovalLaw::kImmediate;
  const auto engine = Make(Slab(14e-3, 4e-3, true, kSoft), BallTool(2e-3), params);
  const Vector3 start(-5e-3, -1e-3, 0.3e-3), goal(5e-3, 1e-3, -2e-3);
  for (const int frames : {40, 7, 3}) {
    Vector3 before = start;
    for (int i = 0; i <= frames; ++i) {
      const Vector3 asked = start + static_cast<double>(i) / frames * (goal - start) -
                            Vector3(0, 0, 0.3e-3 / frames);  // each run goes a little deeper
      const ContactModel model = engine->Step(At(Down(asked), kSpindle_rad_per_s, 4e-3));
      // the proxy's path is known to some nanometres, in single precision
      EXPECT_LT((Pose(model.X_WP).translation() - asked).norm(), 2e-8) << frames << " " << i;
      // before it cuts, the tool slides along the surface by at most max_slide_m
      const Vector3 contact = before + model.contact_fraction * (asked - before);
      EXPECT_LE((Vector3(model.p_WS_m) - contact).norm(), params.max_slide_m + 2e-8) << frames << " " << i;
      before = asked;
    }
    engine->Step(At(Down(start + Vector3(0, 0, 20e-3))));
    engine->Step(At(Down(start)));
  }
}

// The tool moves to and fro at 100 mm/s, pressed with 40 N. In frames of 6 ms its slide exceeds a frame's
// limit; the spindle must nevertheless cut at least 0.7 of the volume that it cuts in frames of 1 ms.
TEST_P(EngineCutting, LateFramesCutNearlyAsMuchOfAToolThatMovesAcross) {
  std::vector<double> removed_m3;
  for (const int ms : {1, 6}) {
    const auto engine = Make(Slab(14e-3, 4e-3, true, kSoft), BallTool(2e-3));
    ContactModel model = engine->Step(At(Down({0, 0, 0.2e-3})));
    double z = 0.0;  // height of the tool: 2 mm below the proxy, for 40 N
    for (int i = 0; i < 120 / ms; ++i) {
      const double t = 1e-3 * ms * i, x = 2e-3 * std::asin(std::sin(std::numbers::pi * t / 40e-3)) / 1.57;
      z = Pose(model.X_WP).translation().z() - 2e-3;
      model = engine->Step(At(Down({x, 0, std::min(z, -2e-3)}), kSpindle_rad_per_s, 1e-3 * ms));
    }
    removed_m3.push_back(model.removed_volume_m3);
  }
  EXPECT_GT(removed_m3[0], 1e-10);
  EXPECT_GT(removed_m3[1], 0.7 * removed_m3[0]) << removed_m3[0] << " " << removed_m3[1];
}

TEST_P(EngineCutting, APlungeRemovesTheVolumeOfASphericalCap) {
  const double R = 10e-3;
  const auto engine = Make(Slab(24e-3, 6e-3, true, kSoft), BallTool(R));
  engine->Step(At(Down({0, 0, 0.2e-3}), kSpindle_rad_per_s));
  ContactModel model;
  for (int i = 0; i < 600; ++i)
    model = engine->Step(At(Down({0, 0, 0.2e-3 - 0.01e-3 * i}), kSpindle_rad_per_s));
  const double depth = -Pose(model.X_WP).translation().z();
  EXPECT_GT(depth, 2.5e-3);
  const double cap = M_PI * depth * depth * (R - depth / 3.0);
  EXPECT_NEAR(model.removed_volume_m3, cap, 0.03 * cap) << depth;
  EXPECT_NEAR(model.removed_mass_kg, 500.0 * model.removed_volume_m3, 1e-12);
}

// The limit is that of row 20 in docs/failures.md.
TEST_P(EngineCutting, TheDrivesWorkEqualsTheCutsEnergy) {
  const auto engine = Make(Slab(24e-3, 6e-3), BallTool(8e-3));
  const double dt = 2e-3;
  double drive_J = 0.0;
  ContactModel model = engine->Step(At(Down({-3e-3, 0, 0.2e-3}), kSpindle_rad_per_s, dt));
  for (int i = 0; i < 2000; ++i) {
    const double t = i * dt;
    // 4 s: down at 3 mm/s, then along at 2 mm/s
    const Vector3 p(-3e-3 + 2e-3 * std::max(0.0, t - 1.0), 0, 0.2e-3 - 3e-3 * std::min(t, 1.5));
    model = engine->Step(At(Down(p), kSpindle_rad_per_s, dt));
    drive_J += model.spindle_torque_Nm * kSpindle_rad_per_s * dt;
  }
  std::printf("drive %.3f J, cut %.3f J\n", drive_J, model.cutting_work_J);
  EXPECT_GT(model.cutting_work_J, 2.0);
  EXPECT_NEAR(drive_J, model.cutting_work_J, 0.05 * model.cutting_work_J);
  EXPECT_NEAR(model.cutting_work_J, kSpongy * model.removed_volume_m3, 1e-6 * model.cutting_work_J);
}

/// Mean force over the plunge's second half, and the removed volume.
struct Plunged {
  double force_N, volume_m3;
};
/// Moves the tool down at 2.5 mm/s and along at 1.5 mm/s for 1.2 s.
Plunged Plunge(CuttingEngine& engine, double dt_s) {
  const int frames = static_cast<int>(std::lround(1.2 / dt_s));
  double impulse = 0.0;
  ContactModel model = engine.Step(At(Down({-1e-3, 0, 0.2e-3}), kSpindle_rad_per_s, dt_s));
  for (int i = 1; i <= frames; ++i) {
    const double t = i * dt_s;
    model = engine.Step(At(Down({-1e-3 + 1.5e-3 * t, 0, 0.2e-3 - 2.5e-3 * t}), kSpindle_rad_per_s, dt_s));
    if (2 * i > frames) impulse += Vector3(model.F_T_W.f).norm() * dt_s;
  }
  return {impulse / 0.6, model.removed_volume_m3};
}

// The limit is that of row 22 in docs/failures.md.
TEST_P(EngineCutting, ForceAndVolumeDoNotDependOnTheFrameRate) {
  const Bone bone = Slab(22e-3, 5e-3);
  const Tool tool = BallTool(8e-3);
  std::vector<Plunged> runs;
  for (const double hz : {250.0, 500.0, 1000.0, 2000.0}) {
    runs.push_back(Plunge(*Make(bone, tool), 1.0 / hz));
    std::printf("%4.0f Hz: %.3f N, %.4f mm^3\n", hz, runs.back().force_N, runs.back().volume_m3 * 1e9);
  }
  // Guards against a run without contact, in which all rates agree. At 2.8 mm of depth and 20 N/mm the force
  // is up to 56 N, less as the tool cuts.
  EXPECT_GT(runs.back().force_N, 1.0) << "nothing pressed: all rates agree on that";
  EXPECT_GT(runs.back().volume_m3, 1e-9) << "nothing cut";
  for (const Plunged& run : runs) {
    EXPECT_NEAR(run.force_N, runs.back().force_N, 0.02 * runs.back().force_N);
    EXPECT_NEAR(run.volume_m3, runs.back().volume_m3, 0.02 * runs.back().volume_m3);
  }
}

// failures.md row 20: the tool gains no energy from touching, cutting and leaving.
TEST_P(EngineCutting, ClosedCyclesNeverReturnEnergy) {
  const auto engine = Make(Slab(16e-3, 4e-3), BallTool(6e-3));
  Vector3 p(0, 0, 0.5e-3), f = Vector3::Zero();
  engine->Step(At(Down(p), kSpindle_rad_per_s));
  double work_J = 0.0, min_J = 0.0;
  for (int cycle = 0; cycle < 10; ++cycle) {
    const bool cutting = cycle % 2 == 0;
    for (int i = 1; i <= 60; ++i) {
      const double phase = 2.0 * M_PI * i / 60.0;
      const Vector3 next(0.5e-3 * std::sin(phase), 0.3e-3 * std::sin(2 * phase),
                         -0.5e-3 + 1.0e-3 * std::cos(phase));
      const ContactModel model = engine->Step(At(Down(next), cutting ? kSpindle_rad_per_s : 0.0));
      // work of the hand on the bone (trapezoidal rule), with a minus because F_T_W is the force on the hand
      work_J -= 0.5 * (f + Vector3(model.F_T_W.f)).dot(next - p);
      f = model.F_T_W.f;
      p = next;
    }
    // after each closed cycle; tolerance of a tenth of a millijoule for the trapezoidal rule
    min_J = std::min(min_J, work_J);
  }
  EXPECT_GE(min_J, -1e-4);
  EXPECT_GT(work_J, 0.0);
}

// failures.md row 5: the tool cuts a slot; then it tilts and is withdrawn with the spindle at rest. The
// head's centre stays above the surface: in a deeper slot the undercut would rightly hold the head.
TEST_P(EngineCutting, AToolWithdrawsFreelyFromItsOwnSlot) {
  CuttingParams params;
  params.law = RemovalLaw::kImmediate;
  const auto engine =
      Make(Slab(16e-3, 5e-3, false), MakeReamer(2e-3, 1e-3, 6e-3, 0.9, Vector3::Zero()), params);
  engine->Step(At(Down({-3e-3, 0, 0.1e-3}), kSpindle_rad_per_s));
  for (int i = 0; i <= 200; ++i)
    engine->Step(At(Down({-3e-3 + 0.03e-3 * i, 0, std::max(-1.7e-3, -0.04e-3 * i)}), kSpindle_rad_per_s));
  // tilts about the head's centre, across the slot and along it
  const Vector3 head(3e-3, 0, 0.3e-3);
  const auto tilted = [&](double tilt, double up_m) {
    const Pose turned = Down(Vector3::Zero(), {tilt, 0.5 * tilt, 0});
    return Down(head + Vector3(0, 0, up_m) + turned.linear() * Vector3(0, 0, 2e-3), {tilt, 0.5 * tilt, 0});
  };
  ContactModel model;
  for (int i = 0; i <= 50; ++i) model = engine->Step(At(tilted(0.15 * i / 50.0, 0.0)));
  EXPECT_LT((Pose(model.X_WP).translation() - tilted(0.15, 0.0).translation()).norm(), 0.05e-3);
  for (int i = 0; i <= 150; ++i) {
    model = engine->Step(At(tilted(0.15, 0.05e-3 * i)));
    // the collision-free pose follows at once: 0.05 mm a frame, plus what is left of the tilt
    ASSERT_LT((Pose(model.X_WP).translation() - tilted(0.15, 0.05e-3 * i).translation()).norm(), 0.1e-3) << i;
  }
  EXPECT_EQ(Vector3(model.F_T_W.f).norm(), 0.0);
  EXPECT_LT((Pose(model.X_WP).translation() - tilted(0.15, 7.5e-3).translation()).norm(), 1e-7);
}

TEST_P(EngineCutting, TheAdvanceFollowsTheEnergyBalance) {
  // the tool is held 4 mm deep in the slab: x' = -c K x, with c from the area engaged at that moment
  const double R = 10e-3;
  const auto engine = Make(Slab(24e-3, 6e-3, true, 4.0 * kSoft), BallTool(R));
  engine->Step(At(Down({0, 0, 0.1e-3}), kSpindle_rad_per_s));
  double z = 0.0;
  for (int i = 0; i < 300; ++i) {
    const ContactModel model = engine->Step(At(Down({0, 0, -4e-3}), kSpindle_rad_per_s));
    const double depth = -Pose(model.X_WP).translation().z();
    if (i > 50 && i % 50 == 0) {
      // area of the tool's section with the surface, averaged over the measuring layer of depth e; the mean
      // distance of a disc's points from its axis is 2/3 of its radius
      const double area = M_PI * (std::pow(R + 0.25e-3, 2) - std::pow(R - depth, 2));
      const double arm = 2.0 / 3.0 * std::sqrt(area / M_PI);
      EXPECT_NEAR(model.engaged_area_m2, area, 0.12 * area) << i;
      const double force = 20e3 * (4e-3 - depth);
      const double expected = force * 0.8 * arm * kSpindle_rad_per_s / (4.0 * kSoft * area);
      EXPECT_NEAR(model.advance_m_per_s, expected, 0.35 * expected) << i;
      EXPECT_NEAR(model.spindle_torque_Nm, 0.8 * force * arm, 0.1 * 0.8 * force * arm) << i;
    }
    EXPECT_GE(depth, -z - 1e-7) << i;
    z = -depth;
  }
  EXPECT_LT(z, -1.4e-3);
}

}  // namespace
}  // namespace osteon::simulation
