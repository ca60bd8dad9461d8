#include "simulation/tools/tool.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace osteon::simulation {
namespace {

TEST(Reamer, HasOneCuttingHeadWithItsApexAtTheToolsOrigin) {
  const Tool tool = MakeReamer(0.025, 0.008, 0.12, 0.9, Vector3::Zero());
  int cutting = 0;
  for (const ToolBall& ball : tool.balls) cutting += ball.cutting ? 1 : 0;
  EXPECT_EQ(cutting, 1);
  const ToolBall& head = tool.balls.front();
  EXPECT_TRUE(head.cutting);
  EXPECT_EQ(Vector3(head.center_m), Vector3(0, 0, -0.025));
  EXPECT_EQ(head.radius_m, 0.025);
  EXPECT_NE(tool.name.find("50 mm"), std::string::npos) << tool.name;
}

TEST(Reamer, HasAShaftOfTheRequestedLengthWithoutGaps) {
  const Tool tool = MakeReamer(0.025, 0.008, 0.12, 0.9, Vector3::Zero());
  double last_z = -0.025, reach = -0.05;
  for (const ToolBall& ball : tool.balls) {
    if (ball.cutting) continue;
    const Vector3 c = ball.center_m;
    EXPECT_EQ(ball.radius_m, 0.008);
    EXPECT_EQ(Vector3(c.x(), c.y(), 0), Vector3::Zero());
    if (last_z != -0.025) {
      EXPECT_LE(last_z - c.z(), 0.008 + 1e-12);  // each overlaps the previous one by half a diameter at least
    }
    last_z = c.z();
    reach = std::min(reach, c.z());
  }
  EXPECT_NEAR(reach, -0.05 - 0.12, 0.008 + 1e-12);  // the last centre is within a ball of the end
}

TEST(Reamer, WithoutAShaftIsTheHeadAlone) {
  EXPECT_EQ(MakeReamer(0.01, 0.005, 0.0, 0.9, Vector3::Zero()).balls.size(), 1u);
}

TEST(Reamer, RefusesImpossibleSizes) {
  EXPECT_THROW((void)MakeReamer(0.0, 0.008, 0.12, 0.9, Vector3::Zero()), std::invalid_argument);
  EXPECT_THROW((void)MakeReamer(0.025, -0.008, 0.12, 0.9, Vector3::Zero()), std::invalid_argument);
  EXPECT_THROW((void)MakeReamer(0.025, 0.008, -0.1, 0.9, Vector3::Zero()), std::invalid_argument);
  EXPECT_THROW((void)MakeReamer(0.025, 0.025, 0.1, 0.9, Vector3::Zero()), std::invalid_argument);
  EXPECT_THROW((void)MakeReamer(std::nan(""), 0.008, 0.1, 0.9, Vector3::Zero()), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::simulation
