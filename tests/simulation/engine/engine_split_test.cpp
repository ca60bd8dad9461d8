#include <algorithm>
#include <cstdio>
#include <vector>

#include "simulation/packing/split_packing.h"
#include "simulation/removal/cut_metrics.h"
#include "simulation/tools/swept_tool.h"
#include "tests/oracles/depth_table.h"
#include "tests/simulation/engine/engine_bench.h"

// Tests of two options on every engine: large bone balls are split where the tool cuts them, and only the
// tool ball that touches first cuts (Cutters::kContactSphere).

namespace osteon::simulation {
namespace {

/// The block of the depth table, packed with balls to be split, with mass points.
Bone Block() {
  const DepthScene scene = MakeBlockScene();
  Bone bone = EmptyBone(kSoft);
  bone.balls = BuildSplitPacking(*scene.solid, *scene.zone, {});
  bone.points =
      BuildMassPoints(*scene.solid, EverywhereZone(), {.cells = {.finest_m = 0.5e-3, .coarser_from_m = {}}});
  return bone;
}

/// A run's last model, and the proxy's pose X_WP of each frame.
struct CutRun {
  ContactModel last;
  std::vector<Pose> proxies;
};

/// Cuts along the scene's path, with the immediate law.
CutRun Cut(CuttingEngine& engine, const DepthScene& scene, double step_m) {
  CutRun run;
  for (const Pose& X : scene.Path(step_m)) {
    run.last = engine.Step(At(X, kSpindle_rad_per_s));
    run.proxies.push_back(run.last.X_WP);
  }
  return run;
}

/// Removal at once, with splitting; a frame may slide by 1 mm, so that the proxy keeps up with the path.
CuttingParams Immediate() {
  CuttingParams params;
  params.law = RemovalLaw::kImmediate;
  params.max_slide_m = 1e-3;
  params.split.on = true;
  return params;
}

using EngineSplit = Engine;
OSTEON_ON_EVERY_ENGINE(EngineSplit);

TEST_P(EngineSplit, NothingIsLeftInTheProxysPathAndTheMassIsThatOfTheSweep) {
  const DepthScene scene = MakeBlockScene();
  const Bone bone = Block();
  const auto engine = Make(bone, scene.tool, Immediate());
  const CutRun run = Cut(*engine, scene, 0.25e-3);
  EXPECT_LT((run.proxies.back().translation() - scene.Path(0.25e-3).back().translation()).norm(), 0.05e-3);
  const CarvedState state = engine->Snapshot();
  const std::vector<Ball> live = LiveBalls(state);
  EXPECT_GT(state.split_balls.size(), 100u);
  EXPECT_GT(live.size(), 3000u);
  const SweptTool swept(scene.tool, run.proxies);
  double overlap = 0.0;
  for (const Ball& ball : live)
    overlap = std::max(overlap, ball.radius_m - swept.SignedDistance(ball.center_m));
  // tolerance: SweptTool joins the frames' poses, 0.25 mm apart, by chords; the proxy's own path bends at
  // contact and slide
  EXPECT_LT(overlap, 5e-6);
  const double volume = SweptVolume(*scene.solid, scene.tool, run.proxies, 0.1e-3);
  std::printf("swept %.1f mm^3, removed %.1f mm^3\n", volume * 1e9, run.last.removed_volume_m3 * 1e9);
  EXPECT_NEAR(run.last.removed_mass_kg, 500.0 * volume, 0.02 * 500.0 * volume);
  EXPECT_EQ(run.last.balls_not_split, 0u);
}

// The pool has room for 10 split balls: further balls are removed or shrunk whole.
TEST_P(EngineSplit, AnExhaustedPoolIsReportedAndTheCutGoesOn) {
  const DepthScene scene = MakeBlockScene();
  CuttingParams params = Immediate();
  params.split.pool_blocks = 10;
  const auto engine = Make(Block(), scene.tool, params);
  const CutRun run = Cut(*engine, scene, 0.5e-3);
  EXPECT_GT(run.last.balls_not_split, 50u);
  EXPECT_LE(engine->Snapshot().split_balls.size(), 10u);
  EXPECT_LT((run.proxies.back().translation() - scene.Path(0.5e-3).back().translation()).norm(), 0.05e-3);
  const SweptTool swept(scene.tool, run.proxies);
  for (const Ball& ball : LiveBalls(engine->Snapshot()))
    ASSERT_LT(ball.radius_m - swept.SignedDistance(ball.center_m), 10e-6);
}

// Engine `two` has cut further when the state is restored, so its split balls have other numbers.
TEST_P(EngineSplit, ContinuesFromARestoredStateBitForBit) {
  const DepthScene scene = MakeBlockScene();
  const Bone bone = Block();
  CuttingParams params = Immediate();
  params.split.blocks_per_frame = 3;
  const auto one = Make(bone, scene.tool, params), two = Make(bone, scene.tool, params);
  const std::vector<Pose> path = scene.Path(0.5e-3);
  for (std::size_t i = 0; i < 9; ++i) one->Step(At(path[i], kSpindle_rad_per_s));
  for (std::size_t i = 0; i < 15; ++i) two->Step(At(path[i], kSpindle_rad_per_s));
  const CarvedState middle = one->Snapshot();
  ASSERT_GT(middle.split_balls.size(), 10u);
  one->Restore(middle);
  two->Restore(middle);
  for (std::size_t i = 9; i < path.size(); ++i) {
    const ContactModel a = one->Step(At(path[i], kSpindle_rad_per_s)),
                       b = two->Step(At(path[i], kSpindle_rad_per_s));
    ASSERT_EQ(a.X_WP.p.z, b.X_WP.p.z) << i;
    ASSERT_EQ(a.F_T_W.f.z, b.F_T_W.f.z) << i;
    ASSERT_EQ(a.removed_volume_m3, b.removed_volume_m3) << i;
  }
  EXPECT_EQ(HashState(one->Snapshot()), HashState(two->Snapshot()));
  EXPECT_NE(HashState(one->Snapshot()), HashState(middle));
}

/// The plunge alone of the scene's path, in small steps, so that two engines' proxies take nearly equal
/// paths.
std::vector<Pose> Plunge(const DepthScene& scene) {
  std::vector<Pose> path = scene.Path(0.05e-3);
  path.resize(70);
  return path;
}

// Expects the reference and the other engine to split the same balls into the same children, to within
// rounding. Up to five children near the lower limit of the radius may be dropped by one engine alone.
void ExpectEqualSplits(const Tool& tool, const CuttingParams& params, std::size_t min_children) {
  const DepthScene scene = MakeBlockScene();
  const Bone bone = Block();
  const auto reference = MakeEngine(EngineKind::kReference, bone, tool, params),
             other = MakeEngine(kOtherEngine, bone, tool, params);
  double apart_mm = 0.0;
  for (const Pose& X : Plunge(scene)) {
    const Vector3 one(reference->Step(At(X, kSpindle_rad_per_s)).X_WP.p),
        two(other->Step(At(X, kSpindle_rad_per_s)).X_WP.p);
    apart_mm = std::max(apart_mm, 1e3 * (one - two).norm());
  }
  const CarvedState one = reference->Snapshot(), two = other->Snapshot();
  ASSERT_EQ(one.split_balls, two.split_balls);
  ASSERT_EQ(one.split_cuts, two.split_cuts);
  ASSERT_EQ(one.split_slots.size(), two.split_slots.size());
  std::size_t compared = 0, dropped = 0;
  double worst_mm = 0.0;
  for (std::size_t i = 0; i < one.split_slots.size(); i += 4) {
    const float *a = &one.split_slots[i], *b = &two.split_slots[i];
    if ((a[3] > 0.0f) != (b[3] > 0.0f)) ++dropped;
    if (a[3] <= 0.0f || b[3] <= 0.0f) continue;
    ++compared;
    for (int k = 0; k < 4; ++k) worst_mm = std::max(worst_mm, std::abs(double{a[k]} - double{b[k]}));
  }
  std::printf(
      "%zu split, %zu children, %zu dropped by one engine alone, worst %.2g mm, proxies %.2g mm apart\n",
      one.split_balls.size(), compared, dropped, worst_mm, apart_mm);
  EXPECT_GT(compared, min_children);
  EXPECT_LE(dropped, 5u);
  EXPECT_LT(worst_mm, 1e-4 + 2.0 * apart_mm);
  EXPECT_LT(apart_mm, 1e-3);
}
TEST(EngineSplitTwins, SplitTheSameBalls) { ExpectEqualSplits(MakeBlockScene().tool, Immediate(), 500); }

// Only bone balls that the cutting tool ball touches are split. Bone balls that the other tool balls touch
// stay whole.
TEST(EngineSplitTwins, SplitTheSameBallsIfOnlyTheContactSphereCuts) {
  Tool tool;
  for (int i = 0; i < 3; ++i)
    tool.balls.push_back({.center_m = Vector3(1.2e-3 * std::cos(2.1 * i), 1.2e-3 * std::sin(2.1 * i), -2e-3),
                          .radius_m = 2e-3 + 0.05e-3 * i});
  CuttingParams params = Immediate();
  params.cutters = Cutters::kContactSphere;
  ExpectEqualSplits(tool, params, 60);
}

// A budget of two splits a frame delays some splits, but the final shape is the same. A budget of 0 is
// unlimited.
TEST_P(EngineSplit, ABudgetForEachFrameOnlyDelaysSplitting) {
  const DepthScene scene = MakeBlockScene();
  const Bone bone = Block();
  std::vector<double> live;
  for (const std::size_t budget : {0u, 2u}) {
    CuttingParams params = Immediate();
    params.split.blocks_per_frame = budget;
    const auto engine = Make(bone, scene.tool, params);
    std::vector<Pose> proxies;
    const std::vector<Pose> path = Plunge(scene);
    bool waited = false;
    for (const Pose& X : path) {
      proxies.push_back(engine->Step(At(X, kSpindle_rad_per_s)).X_WP);
      if (proxies.size() == 30)
        waited = std::ranges::any_of(engine->Snapshot().split_cuts, [](std::uint32_t n) { return n > 0; });
    }
    EXPECT_EQ(waited, budget > 0);
    for (int i = 0; i < 60; ++i) proxies.push_back(engine->Step(At(path.front(), kSpindle_rad_per_s)).X_WP);
    const CarvedState state = engine->Snapshot();
    EXPECT_TRUE(std::ranges::all_of(state.split_cuts, [](std::uint32_t n) { return n == 0; }));
    const SweptTool swept(scene.tool, proxies);
    for (const Ball& ball : LiveBalls(state))
      ASSERT_LT(ball.radius_m - swept.SignedDistance(ball.center_m), 5e-6);
    live.push_back(static_cast<double>(LiveBalls(state).size()));
  }
  EXPECT_NEAR(live[1], live[0], 0.1 * live[0]);
}

TEST(SplitState, HashDiffersForAnyChangeOfASplitState) {
  CarvedState state;
  state.balls = {0, 0, 0, 0};
  state.split_balls = {0};
  state.split_cuts = {0};
  state.split_slots = {1, 2, 3, 4};
  const std::uint64_t hash = HashState(state);
  for (int which = 0; which < 3; ++which) {
    CarvedState other = state;
    if (which == 0) other.split_balls[0] = 1;
    if (which == 1) other.split_cuts[0] = 1;
    if (which == 2) other.split_slots[3] = 5;
    EXPECT_NE(HashState(other), hash) << which;
  }
}

using EngineCutters = Engine;
OSTEON_ON_EVERY_ENGINE(EngineCutters);

/// Removal at once, by the tool ball alone that touches first.
CuttingParams ContactSphereAlone() {
  CuttingParams params;
  params.law = RemovalLaw::kImmediate;
  params.cutters = Cutters::kContactSphere;
  return params;
}

// The paper's method: only the contact sphere cuts (docs/method.md, deviation 8).
TEST_P(EngineCutters, TheContactSphereAloneLeavesBoneInTheToolsPath) {
  Tool tool;  // a bar of five balls that goes down flat
  tool.name = "bar";
  for (int i = 0; i < 5; ++i)
    tool.balls.push_back({.center_m = Vector3(2e-3 * (i - 2), 0, -2e-3), .radius_m = 2e-3});
  // Indexed by Cutters: greatest depth of remaining balls inside the tool's sweep [m], and removed volume
  // [m^3]
  double left[2] = {0.0, 0.0}, removed[2] = {0.0, 0.0};
  for (const Cutters cutters : {Cutters::kAll, Cutters::kContactSphere}) {
    CuttingParams params = ContactSphereAlone();
    params.cutters = cutters;
    const Bone bone = Slab(16e-3, 6e-3, true, kSoft);
    const auto engine = Make(bone, tool, params);
    std::vector<Pose> proxies;
    ContactModel model;
    for (int i = 0; i <= 12; ++i) {
      model = engine->Step(At(Down({0, 0, 0.1e-3 - 0.05e-3 * i}), kSpindle_rad_per_s));
      proxies.push_back(model.X_WP);
    }
    const SweptTool swept(tool, proxies);
    const auto k = static_cast<std::size_t>(cutters);
    for (const Ball& ball : LiveBalls(engine->Snapshot()))
      left[k] = std::max(left[k], ball.radius_m - swept.SignedDistance(ball.center_m));
    removed[k] = model.removed_volume_m3;
  }
  std::printf("left in the path: all %.2g mm, contact sphere %.3f mm; removed %.1f and %.1f mm^3\n",
              left[0] * 1e3, left[1] * 1e3, removed[0] * 1e9, removed[1] * 1e9);
  EXPECT_LT(left[0], 5e-6);  // rounding and the proxy's chords; the contact sphere leaves ten times as much
  EXPECT_GT(left[1], 0.05e-3);
  EXPECT_LT(removed[1], 0.8 * removed[0]);
}

/// Two balls of radius 1 mm, 10.5 mm apart along x about x_m, their tops at z = 0.
Bone TwoBumps(double x_m) {
  Bone bone = EmptyBone(kSoft);
  for (const double side : {-1.0, 1.0})
    bone.balls.push_back({.center_m = Vector3(x_m + side * 5.25e-3, 0, -1e-3), .radius_m = 1e-3});
  return bone;
}

/// Which of the two balls were cut: bit 0 the left one, bit 1 the right one.
int CutBalls(const CarvedState& state) {
  return (state.balls[3] < 1.0f ? 1 : 0) | (state.balls[7] < 1.0f ? 2 : 0);
}

// Both tool balls touch at the same time up to rounding. Rounding must not decide which ball cuts: the first
// in the tool's order does. If that ball is no cutting ball, nothing is cut.
TEST_P(EngineCutters, TheFirstInTheToolsOrderCutsIfBallsTouchTogether) {
  for (const double first : {-1.0, 1.0})
    for (const bool first_cuts : {true, false}) {
      Tool tool;
      for (const double side : {first, -first})
        tool.balls.push_back({.center_m = Vector3(side * 5e-3, 0, -2e-3),
                              .radius_m = 2e-3,
                              .cutting = first_cuts || side != first});
      for (int place = 0; place < 4; ++place) {
        const double x_m = 0.137e-3 * place;
        const auto engine = Make(TwoBumps(x_m), tool, ContactSphereAlone());
        for (int i = 0; i < 3; ++i) engine->Step(At(Down({x_m, 0, 0.3e-3 - 0.2e-3 * i}), kSpindle_rad_per_s));
        EXPECT_EQ(CutBalls(engine->Snapshot()), !first_cuts   ? 0
                                                : first < 0.0 ? 1
                                                              : 2)
            << place << " " << first;
      }
    }
}

// One of the two tool balls is 1 um lower and therefore touches first.
TEST_P(EngineCutters, TheBallThatTouchesFirstCutsWhateverItsOrder) {
  for (const double lower : {-1.0, 1.0}) {
    Tool tool;
    for (const double side : {-1.0, 1.0})
      tool.balls.push_back(
          {.center_m = Vector3(side * 5e-3, 0, side == lower ? -2e-3 : -2.001e-3), .radius_m = 2e-3});
    const auto engine = Make(TwoBumps(0.0), tool, ContactSphereAlone());
    engine->Step(At(Down({0, 0, 0.3e-3}), kSpindle_rad_per_s));
    engine->Step(At(Down({0, 0, 0.1e-3}), kSpindle_rad_per_s));
    EXPECT_EQ(CutBalls(engine->Snapshot()), 0);
    engine->Step(At(Down({0, 0, -0.1e-3}), kSpindle_rad_per_s));
    EXPECT_EQ(CutBalls(engine->Snapshot()), lower < 0.0 ? 1 : 2);
  }
}

}  // namespace
}  // namespace osteon::simulation
