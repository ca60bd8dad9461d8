#include "hil/arm/servo_arm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tests/base/checked_no_alloc_scope.h"
#include "tests/hil/test_client.h"

namespace osteon::hil {
namespace {

using kinematics::JointVector;

// The limits of an iiwa 14, but with velocity limits that no test reaches.
std::array<kinematics::JointLimits, 7> FastLimits() {
  auto limits = kinematics::Iiwa14().limits;
  for (auto& limit : limits) limit.velocity_rad_per_s = 1e9;
  return limits;
}

// Response q(t) of q'' = w^2 (1 - q) - 2 z w q' to a step of 1 from rest, with the angular frequency w and
// the damping ratio z. The formulas are the textbook's for critical, weak and strong damping.
double StepResponse(double w, double z, double t) {
  if (t <= 0.0) return 0.0;
  if (z == 1.0) return 1.0 - (1.0 + w * t) * std::exp(-w * t);
  if (z < 1.0) {
    const double wd = w * std::sqrt(1.0 - z * z);
    return 1.0 - std::exp(-z * w * t) * (std::cos(wd * t) + z * w / wd * std::sin(wd * t));
  }
  const double s = std::sqrt(z * z - 1.0), p1 = w * (z - s), p2 = w * (z + s);
  return 1.0 - (p2 * std::exp(-p1 * t) - p1 * std::exp(-p2 * t)) / (p2 - p1);
}

// The servo is integrated in closed form, without a truncation error. The tolerance of 1e-12 allows for 500
// roundings.
TEST(ServoArm, FollowsTheAnalyticStepResponse) {
  for (const double z : {0.3, 1.0, 1.7}) {
    for (const double period_s : {0.001, 0.005}) {
      const double w = 2.0 * std::numbers::pi * 15.0;
      ServoArm arm({.bandwidth_hz = 15.0, .damping_ratio = z, .dead_cycles = 3}, FastLimits(), period_s,
                   JointVector::Zero());
      const JointVector target = JointVector::LinSpaced(0.1, 0.7);
      for (int k = 1; k <= 500; ++k) {
        arm.Step(target);
        const double expected = StepResponse(w, z, (k - 3) * period_s);
        for (int i = 0; i < 7; ++i) ASSERT_NEAR(arm.q()[i], target[i] * expected, 1e-12) << z << " " << k;
      }
    }
  }
}

TEST(ServoArm, WholePeriodsOfDeadTimeAreExact) {
  for (const int dead : {0, 1, 3, ServoArm::kMaxDeadCycles}) {
    ServoArm arm({.dead_cycles = static_cast<double>(dead)}, FastLimits(), 1e-3, JointVector::Constant(0.2));
    for (int k = 0; k < dead; ++k) {
      arm.Step(JointVector::Constant(0.3));
      ASSERT_EQ(arm.q(), JointVector::Constant(0.2)) << dead;
    }
    arm.Step(JointVector::Constant(0.3));
    EXPECT_GT(arm.q()[0], 0.2) << dead;
  }
}

// The dead time is a fraction of a period. The response must be the textbook's, delayed by exactly this time.
TEST(ServoArm, FractionsOfAPeriodOfDeadTimeAreExact) {
  const double w = 2.0 * std::numbers::pi * 15.0, T = 1e-3;
  for (const double dead : {0.25, 3.0 + 1e-6, 3.2, 4.5, 31.75}) {
    for (const double z : {0.7, 1.0, 1.24}) {
      ServoArm arm({.damping_ratio = z, .dead_cycles = dead}, FastLimits(), T, JointVector::Zero());
      for (int k = 1; k <= 200; ++k) {
        arm.Step(JointVector::Constant(0.3));
        ASSERT_NEAR(arm.q()[0], 0.3 * StepResponse(w, z, (k - dead) * T), 1e-12) << dead << " " << k;
      }
    }
  }
}

// A servo follows a ramp with a constant lag. The lag is 2 z / w (damping ratio z, angular frequency w) plus
// the dead time of 3 periods plus half a period, the mean delay of the sample-and-hold.
TEST(ServoArm, LagsBehindARampByTimeConstantAndDeadTime) {
  const double w = 2.0 * std::numbers::pi * 15.0, T = 1e-3, speed = 0.5;
  ServoArm arm({}, FastLimits(), T, JointVector::Zero());
  double command = 0.0;
  for (int k = 0; k < 1000; ++k) {
    command = speed * k * T;
    arm.Step(JointVector::Constant(command));
  }
  // after the last step, the time is one period later than the last command
  EXPECT_NEAR(command + speed * T - arm.q()[0], speed * (2.0 / w + 3 * T + 0.5 * T), 2e-6);
}

TEST(ServoArm, KeepsItsVelocityAndAccelerationLimits) {
  const auto limits = kinematics::Iiwa14().limits;
  const double T = 1e-3, max_a = 10.0;
  ServoArm arm({.max_acceleration_rad_per_s2 = max_a}, limits, T, JointVector::Zero());
  JointVector qd = arm.qd(), q = arm.q();
  for (int k = 0; k < 4000; ++k) {
    arm.Step(JointVector::Constant(k < 2000 ? 1.5 : -1.5));
    for (int i = 0; i < 7; ++i) {
      ASSERT_LE(std::abs(arm.qd()[i]), limits[static_cast<std::size_t>(i)].velocity_rad_per_s * (1 + 1e-12));
      ASSERT_LE(std::abs(arm.qd()[i] - qd[i]), max_a * T * (1 + 1e-9));
      ASSERT_LE(std::abs(arm.q()[i] - q[i]),
                limits[static_cast<std::size_t>(i)].velocity_rad_per_s * T * (1 + 1e-9));
    }
    qd = arm.qd(), q = arm.q();
  }
}

TEST(ServoArm, DoesNotAllocate) {
  ServoArm arm({}, FastLimits(), 1e-3, JointVector::Zero());
  rt::CheckedNoAllocScope no_alloc;
  for (int k = 0; k < 100; ++k) arm.Step(JointVector::Constant(0.1));
}

TEST(ServoArm, RefusesParametersOutOfRange) {
  const auto make = [](const ServoArmParams& p) {
    ServoArm arm(p, kinematics::Iiwa14().limits, 1e-3, JointVector::Zero());
  };
  EXPECT_NO_THROW(make({}));
  EXPECT_THROW(make({.bandwidth_hz = 0.0}), std::invalid_argument);
  EXPECT_THROW(make({.damping_ratio = -1.0}), std::invalid_argument);
  EXPECT_THROW(make({.dead_cycles = -1}), std::invalid_argument);
  EXPECT_THROW(make({.dead_cycles = std::nan("")}), std::invalid_argument);
  EXPECT_THROW(make({.dead_cycles = ServoArm::kMaxDeadCycles + 1}), std::invalid_argument);
  EXPECT_THROW(make({.max_acceleration_rad_per_s2 = 0.0}), std::invalid_argument);
  EXPECT_THROW(ServoArm({}, {}, 1e-3, JointVector::Zero()), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::hil
