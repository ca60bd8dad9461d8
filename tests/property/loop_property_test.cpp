// Whatever inputs the servo loop gets, none of its commands exceeds a limit or leaves the workspace, on the
// simulated arm at each of its levels.

#include "tests/property/property_check.h"
#include "tests/property/wild_cell.h"

namespace osteon::property {
namespace {

// Generates one cell and its operations; fails at the first tick that exceeds a limit.
void CheckGeneratedCase(hil::ArmLevel level) {
  const Choice choice = *AnyChoice().as("choice");
  const std::vector<Op> ops = *WildOps(WildCell::kPushes, WildCell::kKinds).as("ops");
  WildCell cell(choice, level);
  for (std::size_t tick = 0; tick < ops.size(); ++tick) {
    const std::string wrong = cell.Tick(ops[tick]);
    if (!wrong.empty()) RC_FAIL("tick " + std::to_string(tick) + ": " + wrong);
  }
}

constexpr int kShards = 8;  // parts of the cases, which ctest runs in parallel
class LoopProperty : public testing::TestWithParam<int> {};

TEST_P(LoopProperty, NoInputMakesTheLoopExceedALimitOnTheKinematicArm) {
  CheckShard(GetParam(), kShards, 25'000, [] { CheckGeneratedCase(hil::ArmLevel::kKinematic); });
}
INSTANTIATE_TEST_SUITE_P(Shard, LoopProperty, testing::Range(0, kShards));

TEST(LoopPropertyLevels, NoInputMakesTheLoopExceedALimitOnAnArmThatLags) {
  CheckShard(100, 1, 1'000, [] { CheckGeneratedCase(hil::ArmLevel::kServo); });
}

TEST(LoopPropertyLevels, NoInputMakesTheLoopExceedALimitOnAnArmWithMasses) {
  CheckShard(101, 1, 1'000, [] { CheckGeneratedCase(hil::ArmLevel::kDynamic); });
}

// Shows that the generated cases reach rendering and high speeds: otherwise the tests above would prove
// nothing.
TEST(LoopPropertyCases, OftenRenderAndComeNearTheSpeedLimit) {
  std::uint64_t rendered = 0, cases = 0, fast = 0;
  CheckShard(102, 1, 2'000, [&] {
    const Choice choice = *AnyChoice();
    const std::vector<Op> ops = *WildOps(WildCell::kPushes, WildCell::kKinds);
    WildCell cell(choice, hil::ArmLevel::kKinematic);
    for (const Op& op : ops) static_cast<void>(cell.Tick(op));
    ++cases;
    rendered += cell.oracle().rendered_ticks();
    fast += cell.oracle().most_speed_share() > 0.5;
  });
  EXPECT_GT(rendered, 4 * cases) << "ticks of it render";
  EXPECT_GT(fast, cases / 20) << "of it reach the tool's speed";
}

}  // namespace
}  // namespace osteon::property
