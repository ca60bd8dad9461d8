#include "control/laws/impedance_law.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

// Tests the impedance law: the velocity that is computed from measured poses, and the wrench of damping and
// brake.

namespace osteon::control {
namespace {

constexpr double kTick_s = 1e-3;

// Pose at x [m] on the x axis, rotated by an angle [rad] about `axis`.
Pose At(double x, double angle, const Vector3& axis) {
  Pose X = Pose::Identity();
  X.translation().x() = x;
  X.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  return X;
}

TEST(MeasuredTwist, ReachesTheVelocityOfASteadyMotion) {
  const Vector3 axis(1.0, 2.0, -0.5);
  MeasuredTwist twist(0.002);
  twist.Reset(At(0.0, 0.0, axis));
  Twist V;
  for (int i = 1; i <= 40; ++i) V = twist.Step(At(0.1 * i * kTick_s, 0.7 * i * kTick_s, axis), kTick_s);
  EXPECT_NEAR(V.v.x(), 0.1, 1e-6) << "40 ms of 2 ms: e^-16 is left of the step";
  EXPECT_LT((V.w - 0.7 * axis.normalized()).norm(), 1e-5);
}

TEST(MeasuredTwist, ATurnOfAlmostPiKeepsItsSign) {
  MeasuredTwist twist(0.0);
  const Vector3 axis(0.0, 0.0, 1.0);
  twist.Reset(At(0.0, 0.0, axis));
  const double angle = std::numbers::pi - 1e-6;
  const Twist V = twist.Step(At(0.0, angle, axis), kTick_s);
  EXPECT_NEAR(V.w.z() * kTick_s, angle, 1e-9);
}

TEST(MeasuredTwist, LostMessagesDoNotRaiseTheVelocity) {
  MeasuredTwist twist(0.002);
  twist.Reset(At(0.0, 0.0, Vector3::UnitX()));
  double x_m = 0.0;
  for (int i = 0; i < 200; ++i) {
    const double dt_s = (i % 5 == 4 ? 6 : 1) * kTick_s;  // every fifth message comes after five lost ones
    x_m += 0.1 * dt_s;
    EXPECT_LE(twist.Step(At(x_m, 0.0, Vector3::UnitX()), dt_s).v.x(), 0.1 * (1.0 + 1e-9)) << i;
  }
  EXPECT_NEAR(twist.V().v.x(), 0.1, 1e-6);
}

TEST(MeasuredTwist, IsZeroAfterAReset) {
  MeasuredTwist twist(0.002);
  twist.Reset(At(0.5, 0.3, Vector3::UnitX()));
  EXPECT_EQ(twist.Step(At(0.5, 0.3, Vector3::UnitX()), kTick_s).v.norm(), 0.0);
}

// The allowed velocity V_allowed is V times a random share from 0 to 1. The damping wrench must never add
// power to the motion.
TEST(DampingWrench, DissipatesPowerForAnyAllowedShareOfTheVelocity) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Vector3(normal(random), normal(random), normal(random)); };
  ImpedanceParams params;
  params.damping_Ns_per_m = {5.0, 20.0, 0.0};
  for (int i = 0; i < 1000; ++i) {
    const Matrix3 R = Eigen::AngleAxisd(normal(random), vector().normalized()).toRotationMatrix();
    const Twist V{.v = vector(), .w = vector()};
    const double share = std::uniform_real_distribution<double>(0.0, 1.0)(random);
    const Wrench F = DampingWrench(params, R, V, {.v = share * V.v, .w = share * V.w});
    EXPECT_LE(F.f.dot(V.v) + F.t.dot(V.w), 0.0);
  }
}

TEST(DampingWrench, DampingActsAlongTheAxesOfTheTool) {
  ImpedanceParams params;
  params.damping_Ns_per_m = {0.0, 0.0, 30.0};
  const Matrix3 R = Eigen::AngleAxisd(std::numbers::pi / 2, Vector3::UnitY()).toRotationMatrix();
  const Twist V{.v = {0.1, 0.2, 0.0}, .w = Vector3::Zero()};
  const Wrench F = DampingWrench(params, R, V, V);
  EXPECT_LT((F.f - Vector3(-3.0, 0.0, 0.0)).norm(), 1e-12) << "z of T is x of W";
}

TEST(ImpedanceParams, RefusesDampingAndTimeConstantOutOfRange) {
  for (const double bad : {-1.0, 1e6, std::numeric_limits<double>::quiet_NaN()}) {
    ImpedanceParams params;
    params.damping_Ns_per_m.y() = bad;
    EXPECT_THROW(Validate(params), std::invalid_argument);
    params = {};
    params.follow_s = bad;
    EXPECT_THROW(Validate(params), std::invalid_argument);
  }
}

}  // namespace
}  // namespace osteon::control
