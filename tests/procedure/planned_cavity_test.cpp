#include "procedure/plan/planned_cavity.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "procedure/plan/surgical_plan.h"
#include "simulation/solids/acetabulum_solid.h"

namespace osteon::procedure {
namespace {

constexpr double kPi = std::numbers::pi;
// The cavity of the demo's plan.
const PlannedCavity kDemo{.centre_m = {0.0, 0.0, -0.002}, .axis = Vector3::UnitZ(), .radius_m = 0.025};

// The demo's cavity is a half ball of 50 mm, 2 mm below the face, and a cylinder from the ball up to the
// face, less the cup of 48 mm that was there.
TEST(PlannedCavity, ClearsTheVolumeOfBallAndCylinderLessTheCup) {
  const simulation::AcetabulumSolid block({});
  const double expected_mm3 = 2.0 / 3.0 * kPi * (std::pow(25.0, 3) - std::pow(24.0, 3)) + kPi * 625.0 * 2.0;
  EXPECT_NEAR(expected_mm3, 7699.0, 0.05);
  EXPECT_NEAR(1e9 * BoneInCavity(block, kDemo, 0.5e-3), expected_mm3, 0.002 * expected_mm3);
}

// A tool of 49 mm cuts first, then one of 50 mm. The second tool removes what the first left, and both
// together remove as much as the second alone.
TEST(PlannedCavity, AToolTakesWhatEarlierToolsLeft) {
  const simulation::AcetabulumSolid block({});
  PlannedCavity wide = kDemo, deep = kDemo;
  wide.radius_m = 0.0245;
  const double whole_mm3 = 1e9 * BoneInCavity(block, kDemo, 0.5e-3),
               first_mm3 = 1e9 * BoneInCavity(block, wide, 0.5e-3),
               rest_mm3 = 1e9 * BoneInCavity(block, kDemo, 0.5e-3, std::span(&wide, 1));
  EXPECT_GT(first_mm3, 1000.0);
  EXPECT_NEAR(first_mm3 + rest_mm3, whole_mm3, 1e-6 * whole_mm3);
  deep.centre_m.z() -= 0.002;  // an earlier tool went 2 mm deeper: it leaves nothing for the 50 mm tool
  EXPECT_LT(1e9 * BoneInCavity(block, kDemo, 0.5e-3, std::span(&deep, 1)), 1e-3 * whole_mm3);
}

TEST(PlannedCavity, LeavesTheWallBetweenItsBallAndTheBlocksSide) {
  const simulation::AcetabulumSolid block({});
  const auto wall_m = PlannedWall(block, block.cup(), kDemo, 2e-3);
  ASSERT_TRUE(wall_m);
  EXPECT_NEAR(1e3 * *wall_m, 15.0, 0.01);
}

TEST(PlannedCavity, DistanceIsThatToTheBallBelowAndToTheCylinderAbove) {
  EXPECT_NEAR(kDemo.DistanceTo({0.0, 0.0, -0.030}), 0.003, 1e-15);
  EXPECT_NEAR(kDemo.DistanceTo({0.030, 0.0, 0.050}), 0.005, 1e-15);
  EXPECT_NEAR(kDemo.DistanceTo({0.0, 0.0, 0.100}), -0.025, 1e-15);
}

// A burr of radius 1 mm whose centre moves within 1 mm of the axis. Its cavity has a flat floor of radius 1
// mm, a round edge, and a wall of radius 2 mm.
TEST(PlannedCavity, OfALedBurrHasAFlatFloorARoundEdgeAndAWall) {
  const PlannedCavity opening{.axis = Vector3::UnitZ(), .radius_m = 1e-3, .around_m = 1e-3};
  EXPECT_DOUBLE_EQ(opening.opening_radius_m(), 2e-3);
  for (const double x_m : {0.0, 0.5e-3, 1e-3})
    EXPECT_NEAR(opening.DistanceTo({x_m, 0.0, -1.3e-3}), 0.3e-3, 1e-15);
  EXPECT_NEAR(opening.DistanceTo({0.0, 2.5e-3, 7e-3}), 0.5e-3, 1e-15);
  const double diagonal_m = 1e-3 + 1.5e-3 / std::sqrt(2.0);
  EXPECT_NEAR(opening.DistanceTo({diagonal_m, 0.0, -1.5e-3 / std::sqrt(2.0)}), 0.5e-3, 1e-15);
  EXPECT_LT(opening.DistanceTo({0.0, 0.0, 0.0}), 0.0);
  // volume under the face of a block: a cylinder, and a disc's floor with a round edge (Pappus's theorem)
  const simulation::AcetabulumSolid block({});
  PlannedCavity below = opening;
  below.centre_m = {34e-3, 0.0, -3e-3};  // beside the cup
  const double floor_mm3 =
      kPi * 1.0 * 1.0 + kPi * kPi / 2.0 + 2.0 / 3.0 * kPi;  // disc, quarter torus, part of the ball
  const double expected_mm3 = kPi * 4.0 * 3.0 + floor_mm3;
  EXPECT_NEAR(1e9 * BoneInCavity(block, below, 0.05e-3), expected_mm3, 0.005 * expected_mm3);
}

// A usual plan: reamers of 44 and 50 mm for an implant of 52 mm.
SurgicalPlan Plan() {
  SurgicalPlan plan;
  plan.cup_diameter_m = 0.052;
  plan.centre_m = {0.0, 0.0, -0.002};
  plan.tools = {{0.044, -0.0015}, {0.050, 0.0}};
  return plan;
}

TEST(SurgicalPlan, AUsualPlanHasNoWarning) { EXPECT_TRUE(WarningsOf(Plan()).empty()); }

TEST(SurgicalPlan, WarnsOfAnImplantThatIsTooTightOrTooLoose) {
  for (const double last_m : {0.0515, 0.0485}) {
    SurgicalPlan plan = Plan();
    plan.tools.back().diameter_m = last_m;
    ASSERT_EQ(WarningsOf(plan).size(), 1u) << last_m;
    EXPECT_NE(WarningsOf(plan)[0].find("implant"), std::string::npos);
  }
  for (const double last_m : {0.051, 0.049}) {
    SurgicalPlan plan = Plan();
    plan.tools.back().diameter_m = last_m;
    EXPECT_TRUE(WarningsOf(plan).empty()) << last_m << ": the bounds themselves are usual";
  }
}

TEST(SurgicalPlan, WarnsOfAReamerThatLeavesThePlannedCavity) {
  SurgicalPlan plan = Plan();
  plan.tools.front().height_m = -0.004;  // its apex is 1 mm below the last tool's
  ASSERT_EQ(WarningsOf(plan).size(), 1u);
  EXPECT_NE(WarningsOf(plan)[0].find("1 mm deeper"), std::string::npos) << WarningsOf(plan)[0];
}

TEST(SurgicalPlan, RefusesAnAxisMoreThan45DegreesOffTheSite) {
  SurgicalPlan plan = Plan();
  const auto tilted = [&](double deg) {
    plan.axis_G = {std::sin(deg * kPi / 180.0), 0.0, std::cos(deg * kPi / 180.0)};
    return SiteError(plan, simulation::CutSite{});
  };
  EXPECT_EQ(tilted(44.9), "");
  EXPECT_NE(tilted(45.1), "");
}

}  // namespace
}  // namespace osteon::procedure
