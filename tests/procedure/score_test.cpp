#include "procedure/assessment/score.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "base/units.h"
#include "procedure/assessment/assessment.h"
#include "tests/procedure/reamed_cup.h"

namespace osteon::procedure {
namespace {

// Thickness of the wall that is left beyond the cup: enough that there is no breach.
constexpr double kWallLeft_m = 0.01;

// The shipped rubric (config/rubrics/rubric.yaml; tests/config/rubric_test.cpp compares them). Each item:
// metric, points, the value up to which all points are given, the value from which on none are given, the
// source.
Rubric ShippedRubric() {
  return {.name = "rubric",
          .items = {{"axis_error", 30.0, 5.0 * kDegree, 10.0 * kDegree, ""},
                    {"superior_shift", 15.0, 3e-3, 6e-3, ""},
                    {"medial_shift", 15.0, 5e-3, 8e-3, ""},
                    {"diameter_error", 20.0, 0.3e-3, 1.6e-3, ""},
                    {"coverage", 10.0, 0.77, 0.61, ""},
                    {"over_reamed", 10.0, 0.0, 2e-6, ""}},
          .breach_points = 20.0,
          .breach_source = ""};
}

MetricValues PerfectValues() {
  return {{"axis_error", 0.0},     {"superior_shift", 0.0}, {"medial_shift", 0.0},
          {"diameter_error", 0.0}, {"coverage", 1.0},       {"over_reamed", 0.0}};
}

TEST(Score, IsFullUpToTheFullValueAndFallsLinearlyToNone) {
  EXPECT_NEAR(ScoreOf(ShippedRubric(), PerfectValues(), kWallLeft_m).total, 100.0, 1e-9);
  MetricValues values = PerfectValues();
  values["axis_error"] = 7.5 * kDegree;
  EXPECT_NEAR(ScoreOf(ShippedRubric(), values, kWallLeft_m).total, 85.0, 1e-9);
  values["coverage"] = 0.69;
  EXPECT_NEAR(ScoreOf(ShippedRubric(), values, kWallLeft_m).total, 80.0, 1e-9);
}

TEST(Score, ABreachDeductsPointsUpToAMaximumAndTheScoreIsNeverNegative) {
  EXPECT_NEAR(ScoreOf(ShippedRubric(), PerfectValues(), 0.0).total, 80.0, 1e-9);
  EXPECT_EQ(ScoreOf(ShippedRubric(), PerfectValues(), 0.0).deductions.size(), 1u);
  EXPECT_EQ(ScoreOf(ShippedRubric(), {}, 0.0).total, 0.0);
  EXPECT_TRUE(ScoreOf(ShippedRubric(), PerfectValues(), std::nullopt).deductions.empty()) << "not measured";
  Rubric harsh = ShippedRubric();
  harsh.breach_points = 90.0;
  EXPECT_NEAR(ScoreOf(harsh, PerfectValues(), 0.0).total, 100.0 - kMaxDeduction, 1e-9);
}

TEST(Score, AFigureThatCouldNotBeMeasuredHasNoPoints) {
  MetricValues values = PerfectValues();
  values.erase("diameter_error");
  const Score score = ScoreOf(ShippedRubric(), values, kWallLeft_m);
  EXPECT_NEAR(score.total, 80.0, 1e-9);
  EXPECT_FALSE(score.items[3].value);
}

TEST(Score, DoublingAnyErrorNeverRaisesTheScore) {
  EXPECT_TRUE(rc::check("a doubled figure, or coverage that misses twice as much", [] {
    const Rubric rubric = ShippedRubric();
    MetricValues values;
    for (const RubricItem& item : rubric.items)
      values[item.metric] = item.metric == "coverage"
                                ? 1.0 - 1e-3 * *rc::gen::inRange(0, 501)
                                : std::max(item.full, item.zero) * 1e-3 * *rc::gen::inRange(0, 2001);
    const double before = ScoreOf(rubric, values, kWallLeft_m).total;
    for (const RubricItem& item : rubric.items) {
      MetricValues worse = values;
      double& value = worse[item.metric];
      value = item.metric == "coverage" ? 1.0 - 2.0 * (1.0 - value) : 2.0 * value;
      RC_ASSERT(ScoreOf(rubric, worse, kWallLeft_m).total <= before);
    }
  }));
}

// Score of reaming the demo's cup with a constant tilt, with a displaced centre, and with a whirl of this
// radius.
double ScoreOfReaming(double tilt_rad, const Vector3& off_m, double whirl_m) {
  static const simulation::Bone bone = CupBone();
  SurgicalPlan plan = DemoPlan();
  const Vector3 feed = Eigen::AngleAxisd(tilt_rad, plan.pelvis.lateral.cross(plan.axis_G).normalized()) *
                       Vector3(-plan.axis_G);
  const simulation::CarvedState state = Ream(bone, 0.025, Whirl(plan.centre_m + off_m, whirl_m), feed);
  Assessment assessment;
  assessment.cavity = AssessCavity(plan, bone, state);
  ReamedAxis axis;
  axis.Add(feed, state.removed_volume_m3);
  assessment.axis_G = axis.value();
  return ScoreOf(ShippedRubric(), ValuesOf(plan, assessment), kWallLeft_m).total;
}

TEST(Score, AScriptedExpertIsAbove85AndANoviceBelow40) {
  const PelvicFrame pelvis = DemoPlan().pelvis;
  EXPECT_GT(ScoreOfReaming(2.0 * kDegree, 0.5e-3 * pelvis.superior, 0.1e-3), 85.0);
  // 14° and 4 mm: upwards and inwards, as novices' cups go
  EXPECT_LT(ScoreOfReaming(14.0 * kDegree, 4e-3 * (pelvis.superior - pelvis.lateral).normalized(), 1e-3),
            40.0);
}

TEST(Score, DoublingAnErrorOfTheHandNeverRaisesTheScore) {
  const PelvicFrame pelvis = DemoPlan().pelvis;
  const Vector3 directions[] = {pelvis.superior,           -pelvis.superior, pelvis.lateral,
                                -pelvis.lateral,           pelvis.anterior,  -pelvis.anterior,
                                Vector3(-Vector3::UnitZ())};
  // The sphere that is fitted to a cavity in packed balls has a diameter within 0.01 mm. The 20 points of the
  // diameter fall over 1.3 mm, so two equally good cuts may differ by 0.2 points.
  constexpr double kTolerance_points = 0.2;
  for (const Vector3& direction : directions) {
    double before = 101.0;
    for (const double off_m : {0.0, 1e-3, 2e-3, 4e-3}) {
      const double score = ScoreOfReaming(0.0, off_m * direction, 0.0);
      EXPECT_LE(score, before + kTolerance_points) << 1e3 * off_m << " mm along " << direction.transpose();
      before = score;
    }
  }
  double before = 101.0;
  for (const double tilt_rad : {0.0, 3.5 * kDegree, 7.0 * kDegree, 14.0 * kDegree}) {
    const double score = ScoreOfReaming(tilt_rad, Vector3::Zero(), 0.0);
    EXPECT_LE(score, before + kTolerance_points) << tilt_rad / kDegree << " degrees";
    before = score;
  }
}

}  // namespace
}  // namespace osteon::procedure
