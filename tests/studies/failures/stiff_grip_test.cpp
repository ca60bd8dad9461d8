#include <filesystem>

#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "studies/failures/loop/grip_trial.h"

// The laws of the shipped cells with a hand that stiffens, on an arm that lags.

namespace osteon::studies {
namespace {

// name, stiffness [N/m], damping [N s/m], mass [kg]
const hil::GridHand kStiff{"stiff", 6000.0, 13.0, 1.1};
const hil::GridHand kClamp{"clamp", 50000.0, 50.0, 0.0};

class StiffGrip : public testing::TestWithParam<const char*> {};

// A cell accepts a tremor of tremor_N before it tests whether the vibration is the hand's. An oscillation of
// the loop must be limited to about that force.
TEST_P(StiffGrip, VibratesByAtMostThreeTimesTheTremorThatTheCellAccepts) {
  const control::ServoParams cell =
      config::LoadCell(std::filesystem::path(OSTEON_SOURCE_DIR) / "config/cells" / GetParam()).servo;
  ASSERT_TRUE(cell.vibration.acts);
  for (const hil::GridHand& hand : {kStiff, kClamp}) {
    GripTrialParams params{.after = hand, .clamp = hand.name == "clamp"};
    params.loop.admittance = cell.admittance;
    params.loop.vibration = cell.vibration;
    const GripTrial trial = RunGripTrial(params);
    EXPECT_FALSE(trial.fault) << hand.name;
    EXPECT_LT(trial.calm_N, 3.0 * cell.vibration.reference.tremor_N) << hand.name;
    params.loop.vibration.acts = false;
    const GripTrial without = RunGripTrial(params);
    if (hand.name == "clamp") {
      EXPECT_TRUE(without.fault || without.calm_N > 2.0 * trial.calm_N)
          << "the law alone: " << without.calm_N << " N, with: " << trial.calm_N;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cells, StiffGrip,
                         testing::Values("demo.yaml", "femoral_canal.yaml", "molar.yaml",
                                         "sawbone_block.yaml", "thin_plate.yaml"));

}  // namespace
}  // namespace osteon::studies
