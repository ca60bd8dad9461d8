#include "control/sensing/hand_force.h"

#include <gtest/gtest.h>

#include "control/sensing/hand_wrench.h"
#include "safety/watchdog.h"
#include "tests/control/loop/servo_parts.h"

namespace osteon::control {
namespace {

constexpr double kPeriod_s = 1e-3;

// Parameters with a tool of 1.2 kg on the force sensor.
ServoParams ParamsWithTool() {
  ServoParams params = ServoBench::Params();
  params.sensor.tool_mass_kg = 1.2;
  params.sensor.tool_center_F_m = Vector3(0.0, 0.01, 0.1);
  return params;
}

// The tool's start pose, moved along x of the world.
Pose ToolAt(double x_m) {
  Pose X_WT = ServoBench::StartPose();
  X_WT.translation().x() += x_m;
  return X_WT;
}

// The sensor's reading while the tool is at rest and a hand pushes at its apex along x of the world.
ForceReading Reading(const ServoParams& params, double push_N, const Wrench& bias = {}) {
  const Pose X_WF = ToolAt(0.0) * ServoBench::FlangeToTool().inverse();
  Wrench F_S = ToolWeight(params.sensor, X_WF);
  F_S.f += X_WF.linear().transpose() * Vector3(push_N, 0.0, 0.0) + bias.f;
  const Vector3 lever_W = ToolAt(0.0).translation() - X_WF.translation();
  F_S.t += X_WF.linear().transpose() * lever_W.cross(Vector3(push_N, 0.0, 0.0)) + bias.t;
  return {.stamp = 1, .F_S = F_S};
}

TEST(HandForce, IsTheHandsPushWithoutTheToolsWeight) {
  const ServoParams params = ParamsWithTool();
  HandForce hand(params, ServoBench::FlangeToTool());
  const Wrench F = hand.ComputeHandWrench(Reading(params, 30.0), 0.0, ToolAt(0.0), kPeriod_s);
  EXPECT_NEAR((F.f - Vector3(30.0, 0.0, 0.0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(F.t.norm(), 0.0, 1e-9) << "it pushes at the tool's apex";
}

TEST(HandForce, IsZeroWithoutAFreshAndTrustedReading) {
  const ServoParams params = ParamsWithTool();
  HandForce hand(params, ServoBench::FlangeToTool());
  ForceReading reading = Reading(params, 30.0);
  EXPECT_EQ(hand.ComputeHandWrench(reading, safety::kNoAge_s, ToolAt(0.0), kPeriod_s).f, Vector3::Zero());
  reading.trusted = false;
  EXPECT_EQ(hand.ComputeHandWrench(reading, 0.0, ToolAt(0.0), kPeriod_s).f, Vector3::Zero());
}

TEST(HandForce, SubtractsTheBiasOfARestFromEveryReading) {
  ServoParams params = ParamsWithTool();
  // a bias is accepted up to the dead zone plus the drag of a creeping tool
  params.admittance.dead_zone_N = 3.0;
  params.admittance.dead_zone_Nm = 0.1;
  HandForce hand(params, ServoBench::FlangeToTool());
  const Wrench bias{.f = {2.0, -1.0, 0.5}, .t = {0.05, 0.0, 0.0}};
  for (int i = 0; i < 600; ++i) hand.EstimateBias(Reading(params, 0.0, bias), ToolAt(0.0));
  EXPECT_FALSE(hand.bias_in_doubt());
  EXPECT_NEAR((hand.bias().f - bias.f).norm(), 0.0, 1e-6);
  const Wrench F = hand.ComputeHandWrench(Reading(params, 30.0, bias), 0.0, ToolAt(0.0), kPeriod_s);
  EXPECT_NEAR((F.f - Vector3(30.0, 0.0, 0.0)).norm(), 0.0, 1e-6);
}

TEST(HandForce, APushBeyondTheLargestBiasIsNotTakenForABias) {
  const ServoParams params = ParamsWithTool();
  HandForce hand(params, ServoBench::FlangeToTool());
  for (int i = 0; i < 600; ++i) hand.EstimateBias(Reading(params, 40.0), ToolAt(0.0));
  EXPECT_TRUE(hand.bias_in_doubt());
  EXPECT_EQ(hand.bias().f, Vector3::Zero());
}

// A sensor also measures the force that accelerates the tool. The loop subtracts the share inertia_share of
// it. It computes the acceleration from the poses and the time between two messages, so the result must not
// depend on that time.
TEST(HandForce, SubtractsAShareOfTheToolsInertiaAtAnyMessagePeriod) {
  ServoParams params = ParamsWithTool();
  params.sensor.inertia_share = 0.5;
  const auto push_after_acceleration = [&](double period_s) {
    HandForce hand(params, ServoBench::FlangeToTool());
    hand.ResetMotion(ToolAt(0.0));
    Wrench F;
    double t_s = 0.0;
    while (t_s < 0.2) {  // the tool accelerates at 2 m/s²
      t_s += period_s;
      F = hand.ComputeHandWrench(Reading(params, 0.0), 0.0, ToolAt(t_s * t_s), period_s);
    }
    return F.f.x();
  };
  EXPECT_NEAR(push_after_acceleration(1e-3), 0.5 * 1.2 * 2.0, 0.05);
  EXPECT_NEAR(push_after_acceleration(4e-3), push_after_acceleration(1e-3), 0.05);
}

}  // namespace
}  // namespace osteon::control
