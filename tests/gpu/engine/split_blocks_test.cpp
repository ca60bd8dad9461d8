#include <set>

#include <gtest/gtest.h>

#include "tests/gpu/engine/engine_twins.h"
#include "tests/gpu/engine/strip_bench.h"

// Tests which balls get a block of memory for their children when balls are split. The device counts the
// children in each block, and the host gives free blocks to other balls.

namespace osteon::gpu {
namespace {

using simulation::CarvedState;
using simulation::ContactModel;
using simulation::FrameInput;

constexpr std::size_t kBlocks = 4;  // so few that most balls must wait for a block
constexpr int kPlunges = 5, kFramesOfAPlunge = 40;

// Cutting that splits balls, with a pool of kBlocks.
simulation::CuttingParams FewBlocks() {
  simulation::CuttingParams params;
  params.law = simulation::RemovalLaw::kImmediate;
  params.max_slide_m = 1e-3;
  params.split.on = true;
  params.split.pool_blocks = kBlocks;
  return params;
}

/// Frame i of a series of plunges: a tool ball plunges into the strip at one place after another, each time
/// until the balls there are gone.
FrameInput PlungeInput(int i) {
  const int place = i / kFramesOfAPlunge, step = i % kFramesOfAPlunge;
  return {.X_WT = Down({3.13e-3 * (place - kPlunges / 2), 0.07e-3, 0.2e-3 - 0.1e-3 * step}),
          .spindle_rad_per_s = kSpindle_rad_per_s};
}

/// Runs the frames first … last - 1 of the plunges in both engines. Expects that the same balls have a block,
/// and that about the same number of balls found none. @returns the number of different balls that had a
/// block.
std::size_t ExpectSameBlocksInPlunges(simulation::CuttingEngine& reference, simulation::CuttingEngine& vulkan,
                                      int first, int last) {
  std::set<std::uint32_t> had_a_block;
  std::uint64_t refused_before = 0;
  ContactModel a, b;
  for (int i = first; i < last && !testing::Test::HasFailure(); ++i) {
    a = reference.Step(PlungeInput(i));
    b = vulkan.Step(PlungeInput(i));
    if (i == first)
      refused_before = a.balls_not_split -
                       b.balls_not_split;  // counted in the earlier frames of the reference engine alone
    const CarvedState one = reference.Snapshot(), two = vulkan.Snapshot();
    EXPECT_EQ(one.split_balls, two.split_balls) << i;
    EXPECT_LE(two.split_balls.size(), kBlocks);
    had_a_block.insert(two.split_balls.begin(), two.split_balls.end());
  }
  // 10 % tolerance: if a ball is touched by less than the rounding of a float, only the reference engine asks
  // for a block
  const double refused = static_cast<double>(a.balls_not_split - refused_before);
  EXPECT_GT(refused, 50.0) << "some balls found no block";
  EXPECT_NEAR(static_cast<double>(b.balls_not_split), refused, 0.1 * refused);
  return had_a_block.size();
}

class SplitBlocks : public testing::TestWithParam<PassVariant> {};
INSTANTIATE_TEST_SUITE_P(, SplitBlocks, testing::Values(PassVariant::kGpu, PassVariant::kProcessor));

TEST_P(SplitBlocks, AreReusedOnceTheirChildrenAreGone) {
  const simulation::Bone bone = Strip(24);
  simulation::ReferenceEngine reference(bone, Ball(2e-3), Pose::Identity(), FewBlocks());
  VulkanParams variant;
  variant.overrides.variant = GetParam();
  const auto vulkan = Open(bone, Ball(2e-3), variant, FewBlocks());
  EXPECT_GT(ExpectSameBlocksInPlunges(reference, *vulkan, 0, kPlunges * kFramesOfAPlunge), 2 * kBlocks);
}

// After a restore the engine must count the children anew. One block in the restored state has no children,
// so the engine must give it to another ball.
TEST_P(SplitBlocks, AreReusedAfterARestore) {
  const simulation::Bone bone = Strip(24);
  simulation::ReferenceEngine reference(bone, Ball(2e-3), Pose::Identity(), FewBlocks());
  constexpr int kFramesBefore = 12;
  for (int i = 0; i < kFramesBefore; ++i) reference.Step(PlungeInput(i));
  CarvedState state = reference.Snapshot();
  ASSERT_GT(state.split_balls.size(), 1u);
  const std::size_t slots = state.split_slots.size() / state.split_balls.size();
  std::fill_n(state.split_slots.begin(), slots, 0.0f);
  VulkanParams variant;
  variant.overrides.variant = GetParam();
  const auto vulkan = Open(bone, Ball(2e-3), variant, FewBlocks());
  reference.Restore(state);
  vulkan->Restore(state);
  EXPECT_GT(ExpectSameBlocksInPlunges(reference, *vulkan, kFramesBefore, kPlunges * kFramesOfAPlunge),
            2 * kBlocks);
}

}  // namespace
}  // namespace osteon::gpu
