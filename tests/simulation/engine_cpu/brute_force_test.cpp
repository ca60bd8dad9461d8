#include <algorithm>
#include <cmath>

#include "tests/gpu/engine/contract_bench.h"
#include "tests/gpu/engine/strip_bench.h"
#include "tests/simulation/engine_cpu/equal_engines.h"
#include "tests/simulation/engine_cpu/stroke_input.h"

// The CPU engine finds near pairs by neighbour lists and bounds. These tests show that its results equal, bit
// for bit, those of a search over all pairs in every pass.

namespace osteon::simulation {
namespace {

// Steps three engines over the strip: one without lists that tests all pairs, one whose lists are built
// ahead, and one whose lists are built when needed. Expects equal bits in every frame, and that the tool
// cuts.
void ExpectListsChangeNoBit(const Bone& bone, const Tool& tool, const CuttingParams& params, int frames) {
  const Pose X_WG = Pose::Identity();
  CpuEngine brute(bone, tool, X_WG, params, {.brute_force = true}), lists(bone, tool, X_WG, params),
      at_once(bone, tool, X_WG, params, {.look_ahead = false});
  const CarvedState uncut = brute.Snapshot();
  ContactModel model;
  int touching = 0;
  for (int i = 0; i < frames; ++i) {
    const FrameInput input = StrokeInput(i);
    model = brute.Step(input);
    touching += model.contact_count > 0 ? 1 : 0;
    ASSERT_EQ(model.status, EngineStatus::kOk);
    ASSERT_TRUE(Identical(model, lists.Step(input))) << "frame " << i;
    ASSERT_TRUE(Identical(model, at_once.Step(input))) << "frame " << i;
  }
  EXPECT_GT(touching, frames / 2);
  EXPECT_NE(brute.Snapshot().balls, uncut.balls);
  EXPECT_TRUE(Identical(brute.Snapshot(), lists.Snapshot()));
  EXPECT_TRUE(Identical(brute.Snapshot(), at_once.Snapshot()));
}

TEST(CpuEngineLists, ChangeNoBitForABallOnAStrip) {
  ExpectListsChangeNoBit(gpu::Strip(60), gpu::Ball(6e-3), {}, 140);
}

TEST(CpuEngineLists, ChangeNoBitForAShellOfBallsOnAStrip) {
  for (const Cutters cutters : {Cutters::kAll, Cutters::kContactSphere}) {
    CuttingParams params;
    params.law = RemovalLaw::kImmediate;
    params.cutters = cutters;
    ExpectListsChangeNoBit(gpu::Strip(60), gpu::Shell(60), params, 140);
  }
}

TEST(CpuEngineLists, ChangeNoBitWhenBallsAreSplit) {
  CuttingParams params;
  params.split.on = true;
  params.split.pool_blocks = 64;
  ExpectListsChangeNoBit(gpu::Strip(60), gpu::Ball(6e-3), params, 140);
}

// The tool moves 4 mm along the strip. A frame rebuilds whole lists only at the start; later lists are
// prepared in small parts in advance.
TEST(CpuEngineLists, AreRarelyRebuiltWithinOneFrame) {
  CpuEngine engine(gpu::Strip(200), gpu::Ball(6e-3), Pose::Identity(), {});
  int made = 0;
  for (int i = 0; i < 400; ++i) {
    Pose X = gpu::Down({1e-5 * i, 0, -0.2e-3});
    engine.Step({.X_WT = X, .spindle_rad_per_s = gpu::kSpindle_rad_per_s, .dt_s = 1e-3});
    made += engine.LastFrameStats().lists_made ? 1 : 0;
  }
  EXPECT_GE(made, 1);
  EXPECT_LE(made, 3);
}

}  // namespace
}  // namespace osteon::simulation
