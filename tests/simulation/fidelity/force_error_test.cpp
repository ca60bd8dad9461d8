#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "simulation/fidelity/force_error.h"

// Tests of the errors between a method's force and the exact force, both given frame by frame.

namespace osteon::simulation {
namespace {

/// A constant force over a number of frames.
std::vector<FeltForce> Steady(std::size_t count, const Vector3& f_N) {
  return std::vector<FeltForce>(count, FeltForce{.f_N = f_N});
}

TEST(ForceErrors, AForceScaledBySevenPercentHasThatRelativeError) {
  const auto exact = Steady(100, {0, 3, 4}), felt = Steady(100, Vector3(0, 3, 4) * 1.07);
  const ForceErrors errors = CompareForces(felt, exact, 1000.0);
  EXPECT_NEAR(errors.force_rms_N, 0.35, 1e-12);
  EXPECT_NEAR(errors.force_relative, 0.07, 1e-12);
  EXPECT_NEAR(errors.normal_max_deg, 0.0, 1e-6);
  EXPECT_EQ(errors.force_jump_N_per_ms, 0.0);
  EXPECT_TRUE(errors.touched);
}

TEST(ForceErrors, AForceRotatedByTwoDegreesHasThatAngleError) {
  const double angle = 2.0 * std::numbers::pi / 180.0;
  const auto exact = Steady(10, {0, 0, 10}),
             felt = Steady(10, {10 * std::sin(angle), 0, 10 * std::cos(angle)});
  const ForceErrors errors = CompareForces(felt, exact, 1000.0);
  EXPECT_NEAR(errors.normal_rms_deg, 2.0, 1e-9);
  EXPECT_NEAR(errors.normal_max_deg, 2.0, 1e-9);
  EXPECT_NEAR(errors.force_rms_N, 20.0 * std::sin(0.5 * angle), 1e-9);  // chord of the angle
}

// One of 100 frames has an error of 5 N and 0.2 N·m. At 2 kHz a frame takes 0.5 ms, so the jump in a
// millisecond is twice that.
TEST(ForceErrors, MeasureTheJumpOfASingleFrame) {
  auto felt = Steady(100, {0, 0, 10});
  const auto exact = felt;
  felt[50].f_N.z() = 15.0;
  felt[50].t_Nm.x() = 0.2;
  const ForceErrors errors = CompareForces(felt, exact, 2000.0);
  EXPECT_NEAR(errors.force_jump_N_per_ms, 10.0, 1e-12);
  EXPECT_NEAR(errors.torque_jump_Nm_per_ms, 0.4, 1e-12);
  EXPECT_NEAR(errors.force_rms_N, 0.5, 1e-12);
  EXPECT_NEAR(errors.torque_rms_Nm, 0.02, 1e-12);
}

TEST(ForceErrors, DoNotCountTheExactForcesOwnChangeAsAJump) {
  std::vector<FeltForce> exact;
  for (int k = 0; k < 90; ++k) {
    const double angle = k * std::numbers::pi / 180.0;
    exact.push_back({.f_N = 10.0 * Vector3(std::sin(angle), 0, std::cos(angle))});
  }
  const ForceErrors errors = CompareForces(exact, exact, 1000.0);
  EXPECT_EQ(errors.force_jump_N_per_ms, 0.0);
  EXPECT_NEAR(errors.normal_jump_deg_per_ms, 0.0, 1e-12);
}

TEST(ForceErrors, ReportThatNoForceWasFelt) {
  const ForceErrors errors = CompareForces(Steady(20, Vector3::Zero()), Steady(20, {0, 0, 5}), 1000.0);
  EXPECT_FALSE(errors.touched);
  EXPECT_NEAR(errors.force_relative, 1.0, 1e-12);
  EXPECT_TRUE(CompareForces({}, {}, 1000.0).touched);
}

TEST(ForceErrors, RefuseDifferentNumbersOfFramesAndAZeroRate) {
  EXPECT_THROW((void)CompareForces(Steady(3, Vector3::Zero()), Steady(4, Vector3::Zero()), 1000.0),
               std::invalid_argument);
  EXPECT_THROW((void)CompareForces(Steady(3, Vector3::Zero()), Steady(3, Vector3::Zero()), 0.0),
               std::invalid_argument);
}

}  // namespace
}  // namespace osteon::simulation
