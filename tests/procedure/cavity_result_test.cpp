#include "procedure/assessment/cavity_result.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "procedure/assessment/assessment.h"
#include "tests/procedure/reamed_cup.h"

// The figures of a reamed cavity, compared with the closed forms that docs/procedure.md lists.

namespace osteon::procedure {
namespace {

const simulation::Bone& Bone() {
  static const simulation::Bone bone = CupBone();
  return bone;
}
// The demo's cup, reamed once with 50 mm to this centre. The plan's centre is (0, 0, -2) mm.
CavityResult Reamed(const Vector3& centre_mm, const SurgicalPlan& plan = DemoPlan()) {
  return AssessCavity(plan, Bone(), Ream(Bone(), 0.025, {1e-3 * centre_mm}));
}
constexpr double kVolumeTolerance = 0.02;  // share of the closed form: resolution of the mass points

TEST(CavityResult, ReamingAsPlannedLeavesNothingOverOrUnder) {
  const CavityResult result = Reamed({0.0, 0.0, -2.0});
  EXPECT_NEAR(1e9 * result.removed_m3, 7699.0, kVolumeTolerance * 7699.0);
  EXPECT_LT(1e9 * result.over_m3, 0.02 * 7699.0);
  EXPECT_LT(1e9 * result.under_m3, 0.02 * 7699.0);
  EXPECT_GT(result.coverage, 0.99);
  ASSERT_TRUE(result.rim_preserved);
  EXPECT_GT(*result.rim_preserved, 0.98);
}

TEST(CavityResult, OneMillimetreTooDeepRemovesADiscOfThatHeight) {
  const double expected_mm3 = std::numbers::pi * 625.0;
  EXPECT_NEAR(1e9 * Reamed({0.0, 0.0, -3.0}).over_m3, expected_mm3, kVolumeTolerance * expected_mm3);
}

TEST(CavityResult, TwoMillimetresAsideRemoveALune) {
  const CavityResult result = Reamed({2.0, 0.0, -2.0});
  EXPECT_NEAR(1e9 * result.over_m3, 2162.4, kVolumeTolerance * 2162.4);
  ASSERT_TRUE(result.rim_preserved);
  EXPECT_NEAR(*result.rim_preserved, 0.7999, kVolumeTolerance);
}

TEST(CavityResult, PlannedBoneThatIsLeftIsUnderReamed) {
  EXPECT_NEAR(1e9 * Reamed({1.5, 0.8, -2.5}).under_m3, 1361.0, kVolumeTolerance * 1361.0);
}

TEST(CavityResult, ThePlannedVolumeDoesNotDependOnWhatWasCut) {
  const double planned_m3 = Reamed({0.0, 0.0, -2.0}).PlannedVolume_m3();
  EXPECT_NEAR(1e9 * planned_m3, 7699.0, kVolumeTolerance * 7699.0);
  EXPECT_NEAR(Reamed({1.5, 0.8, -2.5}).PlannedVolume_m3(), planned_m3, 1e-9 * planned_m3);
  EXPECT_NEAR(Reamed({0.0, 0.0, 0.0}).PlannedVolume_m3(), planned_m3, 1e-9 * planned_m3);
}

TEST(CavityResult, AConcentricReamerLeavesTheCartilageBeyondItsRadius) {
  const auto left = Reamed({0.0, 0.0, 0.0}).cartilage_left;
  ASSERT_TRUE(left);
  EXPECT_NEAR(*left, 0.5200, 0.005);
}

TEST(CavityResult, ShiftsAreThoseOfTheReamersCentre) {
  const SurgicalPlan plan = DemoPlan();
  const Vector3 d_mm = 3.0 * plan.pelvis.superior - 2.0 * plan.pelvis.lateral - plan.pelvis.anterior;
  const CavityResult result = Reamed(Vector3(0.0, 0.0, -2.0) + d_mm);
  ASSERT_TRUE(result.fit) << result.fit_refused;
  EXPECT_NEAR(1e3 * result.from_plan.superior_m, 3.0, 0.01);
  EXPECT_NEAR(1e3 * result.from_plan.medial_m, 2.0, 0.01);
  EXPECT_NEAR(1e3 * result.from_plan.posterior_m, 1.0, 0.01);
  // the plan's centre is 2 mm below the native centre along z; the superior component of the unit vector z is
  // -0.7399208
  EXPECT_NEAR(1e3 * result.from_native.superior_m, 3.0 + 2.0 * 0.7399208, 0.01);
}

// The reamer's centre whirls about the axis on a circle of radius w = 0.5 mm. The fitted sphere is larger,
// and its centre is deeper by 0.969 w.
TEST(CavityResult, AWhirlShowsAsALargerDiameterAndALargerResidual) {
  const CavityResult round = Reamed({0.0, 0.0, -2.0});
  const CavityResult result =
      AssessCavity(DemoPlan(), Bone(), Ream(Bone(), 0.025, Whirl({0.0, 0.0, -0.002}, 0.5e-3)));
  ASSERT_TRUE(round.fit && result.fit);
  const double dD_mm = 2e3 * (result.fit->radius_m - 0.025);
  EXPECT_GT(dD_mm, 0.9);
  EXPECT_LT(dD_mm, 1.6);
  EXPECT_GT(result.fit->residual_p95_m, 3.0 * round.fit->residual_p95_m);
}

// The face of a huge ball, nearly a plane, lies 3 mm below the planned centre.
TEST(CavityResult, CoverageIsTheShareOfTheHemisphereBelowAFlatFace) {
  constexpr double kHuge_m = 10.0;
  SurgicalPlan plan = DemoPlan();
  plan.centre_m = Vector3::Zero();
  simulation::Bone bone;
  bone.balls = {{.center_m = Vector3(0.0, 0.0, -kHuge_m - 0.003), .radius_m = kHuge_m}};
  simulation::CarvedState state;
  state.balls = {0.0f, 0.0f, static_cast<float>(-1e3 * (kHuge_m + 0.003)), static_cast<float>(1e3 * kHuge_m)};
  EXPECT_NEAR(AssessCavity(plan, bone, state).coverage, 1.0 - 3.0 / 25.0, 0.005);
}

TEST(CavityResult, AnUncutBoneHasNoFitAndSaysWhy) {
  simulation::CarvedState state;
  for (const simulation::Ball& ball : Bone().balls)
    for (const double v : {ball.center_m.x, ball.center_m.y, ball.center_m.z, ball.radius_m})
      state.balls.push_back(static_cast<float>(1e3 * v));
  state.cleared.assign(Bone().points.size(), 0);
  const CavityResult result = AssessCavity(DemoPlan(), Bone(), state);
  EXPECT_FALSE(result.fit);
  EXPECT_NE(result.fit_refused.find("found 0 cut balls"), std::string::npos) << result.fit_refused;
  EXPECT_EQ(result.removed_m3, 0.0);
}

TEST(RoofArcs, EndAtTheirThreeAnglesAndReachTheRimLaterally) {
  const PelvicFrame pelvis = DemoPlan().pelvis;
  const auto at = [&](double deg, const Vector3& toward_N) {
    const double angle = deg * std::numbers::pi / 180.0;
    return InRoofArcs(pelvis, Vector3::Zero(),
                      0.025 * pelvis.ToG(std::cos(angle) * Vector3::UnitZ() + std::sin(angle) * toward_N));
  };
  EXPECT_TRUE(at(45.9, {-1, 0, 0}));
  EXPECT_FALSE(at(46.1, {-1, 0, 0}));
  EXPECT_TRUE(at(51.9, {0, 1, 0}));
  EXPECT_FALSE(at(52.1, {0, 1, 0}));
  EXPECT_TRUE(at(61.9, {0, -1, 0}));
  EXPECT_FALSE(at(62.1, {0, -1, 0}));
  EXPECT_TRUE(at(89.0, {1, 0, 0}));
}

}  // namespace
}  // namespace osteon::procedure
