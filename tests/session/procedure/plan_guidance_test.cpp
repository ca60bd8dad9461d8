#include "session/procedure/plan_guidance.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include <nlohmann/json.hpp>

#include "config/reading/load_surgical_plan.h"

namespace osteon::session {
namespace {

// The shipped plan of the demo.
procedure::SurgicalPlan Shipped() {
  return config::LoadSurgicalPlan(OSTEON_SOURCE_DIR "/config/plans/acetabulum.yaml").plan;
}

// A pose X_WG of the bone that is neither at the origin nor aligned.
Pose SomePlace() {
  Pose X_WG = Pose::Identity();
  X_WG.linear() = ExpRotation({0.3, -0.2, 0.5});
  X_WG.translation() = Vector3(0.6, 0.1, 0.2);
  return X_WG;
}

TEST(PlanGuidance, IsThePlansGuidanceTransformedToTheWorld) {
  const procedure::SurgicalPlan plan = Shipped();
  const Pose X_WG = SomePlace();
  for (const procedure::PlannedTool& reamer : plan.tools) {
    const auto guidance = GuidanceOf(plan, reamer, X_WG);
    ASSERT_TRUE(guidance);
    EXPECT_LT((guidance->axis_W - X_WG.linear() * plan.axis_G).norm(), 1e-15);
    EXPECT_LT((guidance->centre_W - X_WG * plan.CentreOf(reamer)).norm(), 1e-15);
    EXPECT_EQ(guidance->head_m, 0.5 * reamer.diameter_m);
    EXPECT_EQ(guidance->lateral.stiffness, plan.guidance.lateral.stiffness_N_per_m);
    EXPECT_EQ(guidance->cone.cap, plan.guidance.cone.cap_Nm);
    EXPECT_EQ(guidance->depth.ease, plan.guidance.depth.ease_m);
    EXPECT_EQ(guidance->gain, 1.0);
    EXPECT_TRUE(guidance->stops_spindle);
  }
}

TEST(PlanGuidance, TheShippedPlansGainsAreTheDefaults) {
  const procedure::SurgicalPlan plan = Shipped();
  const auto guidance = GuidanceOf(plan, plan.tools.front(), Pose::Identity());
  const control::GuidanceParams defaults;
  EXPECT_DOUBLE_EQ(guidance->cone.stiffness, defaults.cone.stiffness);
  EXPECT_DOUBLE_EQ(guidance->cone.ease, defaults.cone.ease);
  EXPECT_DOUBLE_EQ(guidance->cone_free_rad, defaults.cone_free_rad);
  EXPECT_DOUBLE_EQ(guidance->cone_stop_rad, defaults.cone_stop_rad);
  EXPECT_DOUBLE_EQ(guidance->lateral.stiffness, defaults.lateral.stiffness);
  EXPECT_DOUBLE_EQ(guidance->lateral.cap, defaults.lateral.cap);
  EXPECT_DOUBLE_EQ(guidance->widening_rad, defaults.widening_rad);
  EXPECT_DOUBLE_EQ(guidance->depth.stiffness, defaults.depth.stiffness);
  EXPECT_DOUBLE_EQ(guidance->return_m_per_s, defaults.return_m_per_s);
}

TEST(PlanGuidance, APlanWithoutGuidanceGivesNone) {
  procedure::SurgicalPlan plan = Shipped();
  plan.guidance = {};
  EXPECT_FALSE(GuidanceOf(plan, plan.tools.front(), Pose::Identity()));
}

TEST(PlanGuidance, FindsThePlansReamerByTheToolsDiameter) {
  const procedure::SurgicalPlan plan = Shipped();
  simulation::Tool tool;
  tool.balls.push_back({.radius_m = 0.5 * plan.tools[2].diameter_m, .cutting = true});
  const auto guidance = GuidanceOf(plan, tool, Pose::Identity());
  EXPECT_LT((guidance->centre_W - plan.CentreOf(plan.tools[2])).norm(), 1e-15);
  tool.balls.front().radius_m = 0.0135;
  EXPECT_THROW(static_cast<void>(GuidanceOf(plan, tool, Pose::Identity())), std::invalid_argument);
}

TEST(PlanGuidance, RefusesGainsOutOfRange) {
  procedure::SurgicalPlan plan = Shipped();
  plan.guidance.lateral.stiffness_N_per_m = 6e3;
  EXPECT_THROW(static_cast<void>(GuidanceOf(plan, plan.tools.front(), Pose::Identity())),
               std::invalid_argument);
}

TEST(PlanGuidance, IsReadBackFromJsonBitForBit) {
  const procedure::SurgicalPlan plan = Shipped();
  const control::GuidanceParams sent = *GuidanceOf(plan, plan.tools[1], SomePlace());
  const nlohmann::json json = ToJson(sent);
  const control::GuidanceParams got = GuidanceFromJson(nlohmann::json::parse(json.dump()));
  EXPECT_EQ(got.axis_W, sent.axis_W);
  EXPECT_EQ(got.centre_W, sent.centre_W);
  EXPECT_EQ(ToJson(got), json);
  nlohmann::json wrong = json;
  wrong["lateral_cap"] = 1e3;
  EXPECT_THROW(static_cast<void>(GuidanceFromJson(wrong)), std::invalid_argument);
  wrong.erase("cone_cap");
  EXPECT_ANY_THROW(static_cast<void>(GuidanceFromJson(wrong)));
}

}  // namespace
}  // namespace osteon::session
