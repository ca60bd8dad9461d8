#include "tests/base/checked_no_alloc_scope.h"
#include "tests/gpu/engine/contract_bench.h"
#include "tests/gpu/engine/strip_bench.h"
#include "tests/simulation/engine_cpu/equal_engines.h"

// Tests that the CPU engine's frames allocate nothing from the first one on: while lists are rebuilt, balls
// are cut and split, and points are cleared.

namespace osteon::simulation {
namespace {

TEST(CpuEngineFrame, DoesNotAllocateWhileReaming) {
  CpuEngine engine(gpu::DefaultBone(), gpu::DefaultReamer(), Pose::Identity(), {});
  gpu::Hand hand;
  ContactModel model;
  rt::CheckedNoAllocScope scope;
  for (int i = 0; i < 300; ++i) model = engine.Step(hand.Next(model.F_T_W.f));
  scope.End();
  EXPECT_GT(model.removed_volume_m3, 1e-9);
}

TEST(CpuEngineFrame, DoesNotAllocateWhileTheToolJumps) {
  CuttingParams params;
  params.law = RemovalLaw::kImmediate;
  params.split.on = true;
  params.split.pool_blocks = 64;
  CpuEngine engine(gpu::Strip(100), gpu::Shell(200), Pose::Identity(), params);
  ContactModel model;
  rt::CheckedNoAllocScope scope;
  for (int i = 0; i < 100; ++i) {
    const Pose X = gpu::Down({(i % 7) * 2e-3, 0, 0.5e-3 - 1e-5 * i - (i % 5) * 0.3e-3});
    model = engine.Step({.X_WT = X, .spindle_rad_per_s = gpu::kSpindle_rad_per_s, .dt_s = 1e-3});
  }
  scope.End();
  EXPECT_EQ(model.status, EngineStatus::kOk);
  EXPECT_GT(model.removed_volume_m3, 0.0);
}

}  // namespace
}  // namespace osteon::simulation
