#include <numeric>
#include <stdexcept>
#include <vector>

#include "simulation/engine_cpu/box_tree.h"
#include "tests/gpu/engine/contract_bench.h"
#include "tests/gpu/engine/strip_bench.h"
#include "tests/simulation/engine_cpu/equal_engines.h"
#include "tests/simulation/engine_cpu/stroke_input.h"

// Tests of the CPU engine at its limits: odd sizes, refused set-ups with their messages, overloaded frames.

namespace osteon::simulation {
namespace {

// The message with which `make` refuses; empty: accepted.
template <class Make>
std::string RefusalOf(Make&& make) {
  try {
    make();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

// The test function accepts all eight boxes of a node; the empty ones among them must not be visited.
TEST(CpuEngineLimits, ASearchVisitsEachExistingClusterOnce) {
  for (const std::size_t count : {1u, 64u, 65u, 64u * 9u, 64u * 65u}) {
    const cpu::BoxTree tree(std::vector<cpu::BoxTree::Box>(count, {.low = {0, 0, 0}, .high = {1, 1, 1}}));
    std::vector<std::uint32_t> visited;
    tree.Find([](const float(&)[6][8]) { return 0xFFu; },
              [&](std::uint32_t cluster) { visited.push_back(cluster); });
    std::vector<std::uint32_t> all(tree.cluster_count());
    std::iota(all.begin(), all.end(), 0u);
    EXPECT_EQ(visited, all) << count;
  }
}

TEST(CpuEngineLimits, RefusalsNameWhatWasFoundAndWhatIsAccepted) {
  const auto make = [](const Bone& bone, const Tool& tool, const CuttingParams& params = {},
                       const CpuParams& cpu = {}) {
    return RefusalOf([&] { CpuEngine(bone, tool, Pose::Identity(), params, cpu); });
  };
  EXPECT_EQ(make(gpu::Strip(2), Tool{}), "tool: found 0 balls, accepted 1 … 10000");
  EXPECT_EQ(make(gpu::Strip(2), gpu::Shell(10'001)), "tool: found 10001 balls, accepted 1 … 10000");
  EXPECT_EQ(make(gpu::Strip(2), gpu::Ball(1e-3), {}, {.instruction_set = "MMX"})
                .rfind("CPU engine: instruction set: found \"MMX\", accepted one of N_", 0),
            0u);
  CuttingParams split;
  split.split = {.on = true, .pool_blocks = 0};
  EXPECT_NE(make(gpu::Strip(2), gpu::Ball(1e-3), split).find("split: pool: found 0"), std::string::npos);
}

TEST(CpuEngineLimits, NamesTheEngineAndItsDevice) {
  for (const std::string& set : CpuInstructionSets()) {
    const CpuEngine engine(gpu::Strip(2), gpu::Ball(1e-3), Pose::Identity(), {}, {.instruction_set = set});
    EXPECT_EQ(engine.name(), "cpu");
    EXPECT_EQ(engine.device().rfind("one thread, ", 0), 0u) << engine.device();
  }
}

// A frame with more pairs than the lists can take changes nothing, and the engine works again in the next
// frame with fewer pairs.
TEST(CpuEngineLimits, AnOverloadedFrameChangesNothing) {
  const Bone bone = gpu::Strip(100);
  CpuEngine engine(bone, gpu::Shell(400), Pose::Identity(), {}, {.list_capacity = 20});
  const FrameInput far{.X_WT = gpu::Down({0, 0, 50e-3}), .spindle_rad_per_s = 1.0, .dt_s = 1e-3};
  EXPECT_EQ(engine.Step(far).status, EngineStatus::kOk);
  const CarvedState before = engine.Snapshot();
  const FrameInput deep{.X_WT = gpu::Down({0, 0, -3e-3}), .spindle_rad_per_s = 1.0, .dt_s = 1e-3};
  EXPECT_EQ(engine.Step(deep).status, EngineStatus::kOverloaded);
  EXPECT_TRUE(Identical(before, engine.Snapshot()));
  EXPECT_EQ(engine.Step(far).status, EngineStatus::kOk);
}

TEST(CpuEngineLimits, AToolOfTenThousandBallsEqualsTheReferenceBitForBit) {
  EqualEngines engines(gpu::Strip(40), gpu::Shell(10'000));
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(engines.Step(StrokeInput(5 * i))) << "frame " << i;
  EXPECT_TRUE(engines.SameStates());
  EXPECT_GT(engines.facts().touching, 5);
}

TEST(CpuEngineLimits, EmptyBonesAndOddSizesEqualTheReferenceBitForBit) {
  for (const int balls : {0, 1, 7, 8, 9, 63, 64, 65, 129}) {
    for (const int tool_balls : {1, 7, 8, 9}) {
      EqualEngines engines(gpu::Strip(balls), gpu::Shell(tool_balls));
      for (int i = 0; i < 30; ++i)
        ASSERT_TRUE(engines.Step(StrokeInput(4 * i))) << balls << " and " << tool_balls << ", frame " << i;
      EXPECT_TRUE(engines.SameStates()) << balls << " and " << tool_balls;
    }
  }
}

TEST(CpuEngineLimits, ARefusedStateChangesNothing) {
  CpuEngine engine(gpu::Strip(40), gpu::Ball(6e-3), Pose::Identity(), {}),
      other(gpu::Strip(41), gpu::Ball(6e-3), Pose::Identity(), {});
  for (int i = 0; i < 60; ++i) engine.Step(StrokeInput(2 * i));
  const CarvedState before = engine.Snapshot();
  EXPECT_THROW(engine.Restore(other.Snapshot()), std::invalid_argument);
  CarvedState bad = before;
  bad.contact.pair_count = 99;
  EXPECT_THROW(engine.Restore(bad), std::invalid_argument);
  EXPECT_TRUE(Identical(before, engine.Snapshot()));
  engine.Restore(before);
  EXPECT_TRUE(Identical(before, engine.Snapshot()));
}

}  // namespace
}  // namespace osteon::simulation
