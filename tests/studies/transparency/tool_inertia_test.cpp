#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "control/sensing/tool_inertia.h"
#include "hil/arm/sensor_load.h"
#include "studies/transparency/handle_bench.h"
#include "tests/kinematics/iiwa14.h"

// The tool's inertia: how it appears in the simulated sensor's load, and how the loop compensates it.

namespace osteon::studies {
namespace {

// A sensor that is turned and offset, with a tool of 1.2 kg and a full inertia tensor.
control::ForceSensorParams Sensor() {
  Pose X_FS = Pose::Identity();
  X_FS.linear() = ExpRotation({0.3, -0.2, 0.9});
  X_FS.translation() << 0.01, -0.02, 0.035;
  Matrix3 I;
  I << 0.004, 0.0002, -0.0001, 0.0002, 0.005, 0.0003, -0.0001, 0.0003, 0.001;
  return {
      .X_FS = X_FS, .tool_mass_kg = 1.2, .tool_center_F_m = Vector3(0.005, 0.0, 0.09), .tool_inertia_F = I};
}

// Simulation and controller compute the tool's inertial wrench by independent formulas: in the body at T, and
// in the world at the flange. After compensation only the hand's wrench must remain.
TEST(ToolInertiaLoad, TheControllerRecoversTheHandsWrench) {
  const control::ForceSensorParams sensor = Sensor();
  Pose X_FT = Pose::Identity();
  X_FT.linear() = ExpRotation({0.0, 0.2, 0.0});
  X_FT.translation() << 0.02, -0.01, 0.18;
  control::MeasuredMotion flange;
  flange.X.linear() = ExpRotation({0.4, -0.7, 0.2});
  flange.X.translation() = Vector3(0.5, 0.1, 0.4);
  flange.V = {.v = {0.2, -0.1, 0.3}, .w = {1.0, -2.0, 0.5}};
  flange.A = {.v = {3.0, 1.0, -2.0}, .w = {8.0, 4.0, -6.0}};
  const Pose X_WT = flange.X * X_FT;
  const Vector3 lever = X_WT.translation() - flange.X.translation();
  const Twist V_WT{.v = flange.V.v + flange.V.w.cross(lever), .w = flange.V.w};
  const Twist A_WT{.v = flange.A.v + flange.A.w.cross(lever) + flange.V.w.cross(flange.V.w.cross(lever)),
                   .w = flange.A.w};
  const Wrench hand{.f = {10.0, -20.0, 5.0}, .t = {0.5, 0.3, -0.7}};

  const Wrench F_S = hil::SubtractInertia(sensor, hil::SensorLoad(sensor, X_WT, flange.X, hand),
                                          {.X_WT = X_WT, .X_WF = flange.X, .V_WT = V_WT, .A_WT = A_WT});
  const Wrench without = control::HandWrench(sensor, F_S, flange.X, X_WT.translation());
  const Wrench inertia = control::InertiaWrench(sensor, flange, X_WT.translation());
  EXPECT_GT((without.f - hand.f).norm(), 1.0) << "what moves the tool is in it";
  EXPECT_LT((without.f + inertia.f - hand.f).norm(), 1e-12);
  EXPECT_LT((without.t + inertia.t - hand.t).norm(), 1e-12);
}

// A bench whose sensor measures the tool's inertial force too; the loop compensates this share of it.
HandleBenchParams Bench(double share) {
  HandleBenchParams params;
  params.arm.level = hil::ArmLevel::kServo;
  params.arm.lbr = kinematics::Iiwa14();
  params.X_FT.translation() = Vector3(0.0, 0.0, 0.2);
  params.arm.p_FT_m = params.X_FT.translation();
  params.arm.q_start << 0.1, 0.5, 0.05, -1.4, 0.1, 0.9, 0.2;
  params.arm_angle_rad = kinematics::LbrArm(params.arm.lbr).ArmAngle(params.arm.q_start);
  params.servo.joints.limits = params.arm.lbr.limits;
  params.servo.workspace.sphere_radius_m = 3.0;
  params.servo.workspace.plane_offset_m = -3.0;
  params.servo.max_tracking_error_m = 0.1;
  params.servo.spindle_rad_per_s = 0.0;
  // the tool's centre is at the apex, so that a push along an axis turns nothing
  params.servo.sensor = {.tool_mass_kg = 1.2, .tool_center_F_m = params.X_FT.translation()};
  params.servo.sensor.inertia_share = share;
  params.sensor_feels_inertia = true;
  return params;
}

// Mass and drag felt at the handle along x at low frequencies.
HandleFit FitAlongX(const HandleBenchParams& params) {
  return FitMassAndDrag(SweepFree(params, {.axis = 0, .frequencies_hz = {0.1, 0.2, 0.4}}), 2.0);
}

TEST(HandleBenchInertia, CompensationRemovesItsShareOfTheToolsMass) {
  HandleBenchParams weightless = Bench(0.0);
  weightless.sensor_feels_inertia = false;
  const double own_kg = FitAlongX(weightless).mass;
  for (const double share : {0.0, 0.4, 0.8})
    EXPECT_NEAR(FitAlongX(Bench(share)).mass, own_kg + (1.0 - share) * 1.2, 0.03) << share;
}

TEST(HandleBenchInertia, CompensationRemovesItsShareOfTheToolsInertia) {
  HandleBenchParams params = Bench(0.8);
  Matrix3 I = Matrix3::Zero();
  I.diagonal() << 0.02, 0.02, 0.005;
  params.servo.sensor.tool_inertia_F = I;
  const auto turned = [&](double share, bool feels) {
    HandleBenchParams bench = params;
    bench.servo.sensor.inertia_share = share;
    bench.sensor_feels_inertia = feels;
    return FitMassAndDrag(SweepFree(bench, {.axis = 4,
                                            .frequencies_hz = {0.1, 0.2},
                                            .max_travel = 0.02,
                                            .max_speed = 0.2,
                                            .max_wrench = 2.0}),
                          2.0)
        .mass;
  };
  const double own = turned(0.0, false);
  EXPECT_NEAR(turned(0.0, true) - own, 0.02, 0.003);
  EXPECT_NEAR(turned(0.8, true) - own, 0.2 * 0.02, 0.003);
}

}  // namespace
}  // namespace osteon::studies
