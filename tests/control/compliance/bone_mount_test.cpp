#include "control/compliance/bone_mount.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

// Tests the elastic mount that holds the bone: the frequency and damping of its oscillation, its displacement
// and tilt under a force, and the creep of its pads.

namespace osteon::control {
namespace {

constexpr double kT_s = 1e-3;

// A mount of this mass and natural frequency.
BoneMountParams Mount(double mass_kg, double hz) {
  BoneMountParams params;
  const double w = 2.0 * std::numbers::pi * hz;
  params.mass_kg = mass_kg;
  params.stiffness_N_per_m.setConstant(mass_kg * w * w);
  params.p_WMo_m = {0.6, 0.1, 0.2};
  return params;
}

TEST(BoneMount, OscillatesAtItsFrequencyAndDecaysByItsDampingRatio) {
  constexpr double kHz = 10.0, kZeta = 0.05;
  BoneMountState state;
  state.d[0] = 1e-3;
  // times [s] of the oscillation's maxima, and the displacement [m] at each
  std::vector<double> at_s, height;
  double last_m = state.d[0], second_last_m = last_m;
  for (int i = 1; i < 1000; ++i) {
    StepMount(Mount(12.0, kHz), {}, kT_s, state);
    if (last_m > second_last_m && last_m >= state.d[0]) {
      at_s.push_back(kT_s * (i - 1));
      height.push_back(last_m);
    }
    second_last_m = last_m;
    last_m = state.d[0];
  }
  ASSERT_GE(height.size(), 6u);
  const double cycles = static_cast<double>(height.size() - 1);
  const double hz = cycles / (at_s.back() - at_s.front());
  EXPECT_NEAR(hz, kHz * std::sqrt(1.0 - kZeta * kZeta), 0.01 * kHz);
  const double decrement = std::log(height.front() / height.back()) / cycles;
  EXPECT_NEAR(decrement / (2.0 * std::numbers::pi), kZeta, 0.02 * kZeta);
}

TEST(BoneMount, MovesByForceOverStiffnessAndTiltsByTheTorque) {
  BoneMountParams params = Mount(12.0, 10.0);
  params.damping_ratio = 0.7;
  const double k = params.stiffness_N_per_m.x();
  EXPECT_NEAR(k, 47.37e3, 0.01e3);
  BoneMountState state;
  constexpr double kLever_m = 0.15;
  for (int i = 0; i < 3000; ++i)
    StepMount(params, {.f = {120.0, 0.0, 0.0}, .t = {0.0, 120.0 * kLever_m, 0.0}}, kT_s, state);
  EXPECT_NEAR(state.d[0], -120.0 / k, 1e-9) << "away from the tool that the bone pushes";
  EXPECT_NEAR(1e3 * -state.d[0], 2.53, 0.01 * 2.53);
  EXPECT_NEAR(state.d[4], -120.0 * kLever_m / params.stiffness_Nm_per_rad.y(), 1e-9);
  const Pose X_WM = MountPose(params, state);
  EXPECT_NEAR((X_WM * params.p_WMo_m - params.p_WMo_m).x(), -120.0 / k, 1e-12);
  EXPECT_NEAR((X_WM * Vector3(params.p_WMo_m + Vector3(0, 0, kLever_m)) - params.p_WMo_m).x(),
              -120.0 / k + kLever_m * std::sin(state.d[4]), 1e-9);
}

TEST(BoneMount, PadsCreepUnderForceAndRecoverWithoutIt) {
  BoneMountParams params = Mount(12.0, 10.0);
  params.creep_N_per_m = 60e3;
  params.creep_tau_s = 2.0;
  BoneMountState state;
  for (int i = 0; i < 2000; ++i)
    StepMount(params, {.f = {120.0, 0.0, 0.0}, .t = Vector3::Zero()}, kT_s, state);
  EXPECT_NEAR(state.creep_m.x(), -120.0 / 60e3 * (1.0 - std::exp(-1.0)), 2e-6);
  for (int i = 0; i < 20'000; ++i) StepMount(params, {}, kT_s, state);
  EXPECT_LT(state.creep_m.norm(), 1e-6);
}

// The velocity that the mount reports for a point must equal the difference of the point's positions over a
// tick.
TEST(BoneMount, TwistIsTheDerivativeOfThePose) {
  const BoneMountParams params = Mount(3.0, 8.0);
  BoneMountState state;
  const Wrench F{.f = {30.0, -20.0, 50.0}, .t = {1.0, 2.0, -1.5}};
  const Vector3 p_M(0.7, 0.05, 0.15);
  for (int i = 0; i < 60; ++i) StepMount(params, F, kT_s, state);
  const Vector3 before = MountPose(params, state) * p_M;
  StepMount(params, F, kT_s, state);
  const Vector3 after = MountPose(params, state) * p_M;
  const Twist V = MountTwistAt(params, state, after);
  EXPECT_LT(((after - before) / kT_s - V.v).norm(), 0.02 * V.v.norm());
}

TEST(BoneMount, RefusesMassOrStiffnessThatIsNotPositive) {
  BoneMountParams params;
  EXPECT_NO_THROW(Validate(params));
  params.mass_kg = 0.0;
  EXPECT_THROW(Validate(params), std::invalid_argument);
  params = {};
  params.stiffness_N_per_m.y() = -1.0;
  EXPECT_THROW(Validate(params), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::control
