#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "base/scramble.h"
#include "simulation/tools/shell_tool.h"
#include "simulation/tools/tool_kinds.h"

namespace osteon::simulation {
namespace {

// Depth in m of the deepest dent between the shell's balls, at random points of the head's sphere whose
// direction from its centre has z >= min_z.
double DeepestDent(const Tool& shell, const ToolBall& head, double min_z) {
  double deepest_m = 0.0;
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const double z = 1.0 - (1.0 - min_z) * Uniform(Scramble(2 * i)),
                 turn = 2.0 * M_PI * Uniform(Scramble(2 * i + 1));
    const double across = std::sqrt(1.0 - z * z);
    const Vector3 p =
        Vector3(head.center_m) + head.radius_m * Vector3(across * std::cos(turn), across * std::sin(turn), z);
    double gap_m = HUGE_VAL;
    for (const ToolBall& ball : shell.balls)
      if (ball.cutting) gap_m = std::min(gap_m, (p - Vector3(ball.center_m)).norm() - ball.radius_m);
    deepest_m = std::max(deepest_m, gap_m);
  }
  return deepest_m;
}

struct Case {
  std::size_t count;
  double deepest_dent_m;  // accepted: 0.13 d at a spacing of d = R sqrt(2 pi / count)
};

TEST(ShellTool, BallsFillTheHemisphereAndNoneProtrudes) {
  const Tool reamer = MakeReamer(ReamerParams{}).tool;
  const ToolBall head = *CuttingHead(reamer);
  const std::size_t touching = reamer.balls.size() - 1;
  for (const Case& each : {Case{200, 0.58e-3}, Case{1000, 0.26e-3}, Case{10'000, 0.082e-3}}) {
    const Tool shell = MakeShellTool(reamer, each.count, ShellPart::kHemisphere);
    ASSERT_EQ(shell.balls.size(), each.count + touching);
    for (const ToolBall& ball : shell.balls) {
      if (!ball.cutting) continue;
      const Vector3 out = Vector3(ball.center_m) - Vector3(head.center_m);
      EXPECT_NEAR(out.norm() + ball.radius_m, head.radius_m, 1e-12);  // touches the sphere from inside
      EXPECT_GE(out.z(), 0.0);
    }
    EXPECT_LT(DeepestDent(shell, head, 0.0), each.deepest_dent_m) << each.count;
    EXPECT_EQ(shell.mass_kg, reamer.mass_kg);
  }
}

TEST(ShellTool, ABurrsShellCoversItsWholeHead) {
  const Tool burr = MakeBurr({.diameter_m = 1.8e-3, .neck_diameter_m = 0.99e-3}).tool;
  const ToolBall head = *CuttingHead(burr);
  const Tool shell = MakeShellTool(burr, 200, ShellPart::kSphere);
  EXPECT_LT(DeepestDent(shell, head, -1.0), 0.02e-3);
}

TEST(ShellTool, WithOneBallTheToolIsUnchanged) {
  const Tool reamer = MakeReamer(ReamerParams{}).tool;
  EXPECT_EQ(MakeShellTool(reamer, 1, ShellPart::kHemisphere).balls.size(), reamer.balls.size());
}

TEST(ShellTool, RefusesBadCountsAndToolsOfSeveralCuttingBalls) {
  const Tool reamer = MakeReamer(ReamerParams{}).tool;
  EXPECT_THROW((void)MakeShellTool(reamer, 0, ShellPart::kHemisphere), std::invalid_argument);
  EXPECT_THROW((void)MakeShellTool(reamer, 100'001, ShellPart::kHemisphere), std::invalid_argument);
  const Tool many = MakeShellTool(reamer, 20, ShellPart::kHemisphere);
  EXPECT_THROW((void)MakeShellTool(many, 20, ShellPart::kHemisphere), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::simulation
