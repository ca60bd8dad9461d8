#include "procedure/assessment/opening_result.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "procedure/assessment/assessment.h"
#include "simulation/bone/scenes.h"
#include "simulation/engine_cpu/cpu_engine.h"
#include "simulation/fidelity/recarve.h"
#include "tests/procedure/reamed_cup.h"

// The figures of a tooth's opening, compared with what the exact path of the tool removes.

namespace osteon::procedure {
namespace {

using simulation::CarvedState;

constexpr double kBurr_m = 0.9e-3;     // radius of the burr
constexpr double kAround_m = 0.85e-3;  // radius of the circles on which its centre moves

const simulation::Bone& Tooth() {
  static const simulation::Bone tooth = [] {
    const simulation::SceneParams scene =
        config::LoadCell(OSTEON_SOURCE_DIR "/config/cells/molar.yaml").scene;
    return simulation::PackScene(simulation::MakeSceneSolid(scene), scene);
  }();
  return tooth;
}

// The shipped plan's last burr.
SurgicalPlan PlanOfTheMolar() {
  SurgicalPlan plan;
  plan.kind = PlanKind::kOpening;
  plan.target = "pulp";
  plan.centre_m = {0.0, 0.0, 0.7e-3};
  plan.pelvis = {.lateral = Vector3::UnitX(), .anterior = Vector3::UnitY(), .superior = Vector3::UnitZ()};
  plan.tools = {{.diameter_m = 2.0 * kBurr_m, .around_m = kAround_m}};
  return plan;
}

// Moves a burr down to `end_m` in layers of 0.2 mm. In each layer its centre goes along circles of up to
// `around_m`, so that the burr cuts a whole disc.
CarvedState Open(const Vector3& end_m, double around_m) {
  simulation::Tool burr;
  burr.balls = {{.center_m = {0.0, 0.0, -kBurr_m}, .radius_m = kBurr_m, .cutting = true}};
  simulation::CpuEngine engine(Tooth(), burr, Pose::Identity(), {.law = simulation::RemovalLaw::kImmediate});
  std::vector<PlainPose> places;
  const Vector3 feed = -Vector3::UnitZ();
  for (double height_m = 8e-3; height_m > -1e-9; height_m -= 0.2e-3)
    for (double radius_m = 0.0; radius_m<around_m + 1e-9; radius_m += around_m> 0.0 ? around_m / 2.0 : 1.0)
      for (int i = 0; i < 24; ++i) {
        const double angle = 2.0 * M_PI * i / 24;
        places.push_back(
            PoseAt(end_m + Vector3(radius_m * std::cos(angle), radius_m * std::sin(angle), height_m), feed,
                   kBurr_m));
      }
  if (!simulation::CarveTrail(engine, places)) throw std::runtime_error("the engine refused a frame");
  return engine.Snapshot();
}

Assessment Assessed(const SurgicalPlan& plan, const CarvedState& state) {
  return {.cavity = AssessCavity(plan, Tooth(), state),
          .opening = AssessOpening(plan, Tooth(), state),
          .axis_G = plan.axis_G,
          .min_wall_m = {},
          .process = {}};
}

TEST(OpeningResult, AnOpeningAsPlannedHasItsDepthAndHardlyAnyOverOrUnder) {
  const SurgicalPlan plan = PlanOfTheMolar();
  const Assessment found = Assessed(plan, Open(plan.centre_m, kAround_m));
  EXPECT_NEAR(*found.opening->depth_error_m, 0.0, 0.03e-3);
  EXPECT_LT(*found.opening->shift_m, 0.03e-3);
  EXPECT_GT(*found.opening->unroofed, 0.99);
  EXPECT_LT(1e9 * found.cavity.over_m3, 1.0);
  EXPECT_LT(1e9 * found.cavity.under_m3, 2.0);
  const MetricValues values = ValuesOf(plan, found);
  EXPECT_FALSE(values.contains("coverage")) << "what is said of a sphere is not said of an opening";
  EXPECT_FALSE(values.contains("diameter_error"));
  EXPECT_TRUE(values.contains("unroofed"));
}

TEST(OpeningResult, DepthShiftAndRoofFollowTheToolsPath) {
  const SurgicalPlan plan = PlanOfTheMolar();
  const OpeningResult deep =
      AssessOpening(plan, Tooth(), Open(plan.centre_m - Vector3(0.0, 0.0, 0.5e-3), kAround_m));
  EXPECT_NEAR(*deep.depth_error_m, 0.5e-3, 0.03e-3);
  const OpeningResult short_of =
      AssessOpening(plan, Tooth(), Open(plan.centre_m + Vector3(0.0, 0.0, 2.0e-3), kAround_m));
  EXPECT_NEAR(*short_of.depth_error_m, -2.0e-3, 0.05e-3);
  EXPECT_LT(*short_of.unroofed, 0.03) << "the roof stands, but for the tips of the pulp's horns";
  const Assessment aside = Assessed(plan, Open(plan.centre_m + Vector3(0.6e-3, 0.8e-3, 0.0), kAround_m));
  EXPECT_NEAR(*aside.opening->shift_m, 1.0e-3, 0.1e-3);
  EXPECT_GT(1e9 * aside.cavity.over_m3, 5.0);
  EXPECT_GT(1e9 * aside.cavity.under_m3, 5.0);
  // A straight hole opens a disc of 0.9 mm radius, but the roof that must be open has a radius of 1.55 mm. A
  // column of 0.25 mm that the hole opens only in part does not count as open.
  const OpeningResult straight = AssessOpening(plan, Tooth(), Open(plan.centre_m, 0.0));
  EXPECT_LT(*straight.unroofed, std::pow(0.90 / 1.55, 2));
  EXPECT_GT(*straight.unroofed, std::pow(0.65 / 1.55, 2));
}

TEST(OpeningResult, AnUncutToothHasNeitherDepthNorShift) {
  const SurgicalPlan plan = PlanOfTheMolar();
  const OpeningResult none = AssessOpening(plan, Tooth(), Open(plan.centre_m + Vector3(0.0, 0.0, 0.05), 0.0));
  EXPECT_FALSE(none.depth_error_m);
  EXPECT_FALSE(none.shift_m);
  EXPECT_EQ(*none.unroofed, 0.0);
}

}  // namespace
}  // namespace osteon::procedure
