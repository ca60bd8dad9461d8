#include "hil/operator/procedure_script.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

// Tests the script of an operator who works with several tools, one after the other.

namespace osteon::hil {
namespace {

// A plan of two tools in 30 s, 15 s each.
ProcedureScriptParams TwoReamers() {
  ProcedureScriptParams params{.X_WC = {}, .head_radius_m = 0.022, .seconds = 30.0};
  params.heights_m = {-0.0015, -0.0005};
  return params;
}

// Place of the head relative to the plan: height of its centre along the axis, distance of its centre from
// the axis, and tilt of the tool from the axis.
struct Place {
  double height_m, aside_m, tilt_rad;
};
Place PlaceAt(const HandScript& script, double time_s, double radius_m) {
  const Pose X = script.Sample(time_s).X_WT;
  const Vector3 centre = X * Vector3(0.0, 0.0, -radius_m);
  return {centre.z(), std::hypot(centre.x(), centre.y()), std::acos(-X.linear().col(2).z())};
}

TEST(ProcedureScript, AnExpertReachesEachPlannedHeightOnTheAxisAndRetracts) {
  const ProcedureScriptParams params = TwoReamers();
  const HandScript script = MakeProcedureScript(params);
  EXPECT_NEAR(script.duration_s(), 30.0, 1e-9);
  for (int tool = 0; tool < 2; ++tool) {
    const double from_s = 15.0 * tool;
    const Place down = PlaceAt(script, from_s + 15.0 * 0.5, params.head_radius_m);
    EXPECT_NEAR(down.height_m, params.heights_m[static_cast<std::size_t>(tool)] - 0.030, 1e-9)
        << "out of the spring's reach by 60 N";
    EXPECT_NEAR(down.aside_m, 0.0, 1e-9);
    EXPECT_NEAR(down.tilt_rad, 0.0, 1e-6);
    EXPECT_EQ(script.Sample(from_s + 15.0 * 0.5).done_height_m,
              params.heights_m[static_cast<std::size_t>(tool)]);
    const Place changing = PlaceAt(script, from_s + 15.0 * 0.9, params.head_radius_m);
    EXPECT_NEAR(changing.height_m, params.retract_height_m, 1e-9);
    EXPECT_EQ(std::string(script.PhaseName(from_s + 13.5)), "change " + std::to_string(tool + 1));
  }
}

TEST(ProcedureScript, TheLastToolIsPushedLonger) {
  ProcedureScriptParams params = TwoReamers();
  // time for which a script of `params` pushes with this tool
  const auto pushed_s = [&](const std::string& tool) {
    const HandScript script = MakeProcedureScript(params);
    int ms = 0;
    for (int i = 0; i < 30'000; ++i) {
      const std::string name = script.PhaseName(1e-3 * i);
      if (name == "push " + tool || name == "finish " + tool) ++ms;
    }
    return 1e-3 * ms;
  };
  EXPECT_NEAR(pushed_s("1"), pushed_s("2"), 0.01);
  params.last_push_ratio = 4.0;
  EXPECT_NEAR(pushed_s("2"), 4.0 * pushed_s("1"), 0.02);
  EXPECT_NEAR(MakeProcedureScript(params).duration_s(), 30.0, 1e-9) << "within the same time";
  params.seconds = 12.0;  // 5 s for the first tool, 7 s for the last
  EXPECT_NEAR(pushed_s("1"), 0.45 * 5.0, 0.02);
  EXPECT_NEAR(pushed_s("2"), 0.45 * 5.0 + 2.0, 0.02);
  params.seconds = 8.0;  // too short for that, so both tools get the same time
  EXPECT_NEAR(pushed_s("1"), pushed_s("2"), 0.01);
  params.last_push_ratio = 0.5;
  EXPECT_THROW((void)MakeProcedureScript(params), std::invalid_argument);
}

TEST(ProcedureScript, ReturnsAHoldAfterEachToolButTheLast) {
  ProcedureScriptParams params = TwoReamers();
  params.last_push_ratio = 4.0;
  const HandScript script = MakeProcedureScript(params);
  const std::vector<ToolHold> holds = HoldsForChanges(script);
  ASSERT_EQ(holds.size(), 1u);
  EXPECT_STREQ(script.PhaseName(holds[0].begin_s + 1e-6), "change 1");
  EXPECT_STREQ(script.PhaseName(holds[0].begin_s + holds[0].length_s - 1e-6), "change 1");
  EXPECT_NEAR(holds[0].begin_s, 4.0 * holds[0].length_s, 1e-9) << "0.8 and 0.2 of a tool's time";
}

TEST(ProcedureScript, ANoviceStaysTiltedAndOffTheAxis) {
  ProcedureScriptParams params = TwoReamers();
  params.tilt_rad = 14.0 * std::numbers::pi / 180.0;
  params.aside_m = 0.004;
  params.sees_plan = false;
  const HandScript script = MakeProcedureScript(params);
  EXPECT_EQ(script.Sample(7.5).done_height_m, HandKey::kNever_m);
  const Place down = PlaceAt(script, 7.5, params.head_radius_m);
  EXPECT_NEAR(down.tilt_rad, params.tilt_rad, 1e-6);
  // 4 mm along x; along y the offset of the tilted axis at this depth below the plan's centre
  const double below_m = params.past_plan_m - params.heights_m.front();
  EXPECT_NEAR(down.aside_m, std::hypot(0.004, below_m * std::sin(params.tilt_rad)), 1e-4);
}

TEST(ProcedureScript, TheSecondBurrGoesDownInLoopsThatWidenAtTheRim) {
  ProcedureScriptParams params = TwoReamers();
  params.head_radius_m = 0.0009;
  params.approach_m = 0.004;
  params.around_m = {0.0, 0.00085};
  const HandScript script = MakeProcedureScript(params);
  double widest_m = 0.0;
  for (double t = 0.0; t < 15.0; t += 0.01)
    widest_m = std::max(widest_m, PlaceAt(script, t, params.head_radius_m).aside_m);
  EXPECT_LT(widest_m, 1e-12) << "the first one goes straight";
  const double rim_m = params.heights_m[1] + params.approach_m;
  for (double t = 15.0; t < 29.9; t += 0.01) {
    const Place place = PlaceAt(script, t, params.head_radius_m);
    if (place.height_m < rim_m - 1e-6 && t < 15.0 + 15.0 * 0.62) {
      EXPECT_NEAR(place.aside_m, 0.00085, 1e-9) << "below the rim at full width, t = " << t;
    }
  }
  params.around_m = {0.0};
  EXPECT_THROW((void)MakeProcedureScript(params), std::invalid_argument) << "one for each tool";
}

TEST(ProcedureScript, RefusesParametersOutOfRange) {
  ProcedureScriptParams params = TwoReamers();
  params.heights_m.clear();
  EXPECT_THROW((void)MakeProcedureScript(params), std::invalid_argument);
  params = TwoReamers();
  params.aside_m = 0.5;
  EXPECT_THROW((void)MakeProcedureScript(params), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::hil
