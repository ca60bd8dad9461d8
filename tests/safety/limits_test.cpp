#include "safety/limits.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"

namespace osteon::safety {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kHuge = std::numeric_limits<double>::max();

// A vector with components over the whole range of exponents, from denormals to the largest double.
Vector3 AnyFinite(std::mt19937_64& random) {
  std::uniform_real_distribution<double> mantissa(-1.0, 1.0), exponent(-320.0, 308.0);
  return {mantissa(random) * std::pow(10.0, exponent(random)),
          mantissa(random) * std::pow(10.0, exponent(random)),
          mantissa(random) * std::pow(10.0, exponent(random))};
}

TEST(WrenchLimiter, NeverLetsMoreThanItsLimitThrough) {
  const WrenchLimiter limiter({.max_force_N = 150.0, .max_torque_Nm = 8.0});
  std::mt19937_64 random(1);
  for (int i = 0; i < 100'000; ++i) {
    const LimitedWrench limited = limiter.Limit({.f = AnyFinite(random), .t = AnyFinite(random)});
    ASSERT_LE(limited.F.f.norm(), 150.0) << "to the last bit, draw " << i;
    ASSERT_LE(limited.F.t.norm(), 8.0);
    ASSERT_GE(limited.share, 0.0);
    ASSERT_LE(limited.share, 1.0);
  }
}

TEST(WrenchLimiter, ScalesTheWholeWrenchAndKeepsItsDirection) {
  const WrenchLimiter limiter({.max_force_N = 200.0, .max_torque_Nm = 10.0});
  const Wrench F{.f = {300.0, -400.0, 0.0}, .t = {0.0, 3.0, 4.0}};  // |f| = 500, |t| = 5
  const LimitedWrench limited = limiter.Limit(F);
  EXPECT_NEAR(limited.share, 0.4, 1e-14);
  EXPECT_TRUE(limited.F.f.isApprox(0.4 * F.f, 1e-14));
  EXPECT_TRUE(limited.F.t.isApprox(0.4 * F.t, 1e-14)) << "the torque shrinks with the force";
  const LimitedWrench by_torque = limiter.Limit({.f = {10.0, 0.0, 0.0}, .t = {0.0, 0.0, 40.0}});
  EXPECT_NEAR(by_torque.F.f.x(), 2.5, 1e-13);
}

TEST(WrenchLimiter, LeavesAWrenchWithinItsLimitsAsItIs) {
  const Wrench F{.f = {0.1, 0.2, 199.0}, .t = {1.0, 2.0, 3.0}};
  const LimitedWrench limited = WrenchLimiter({}).Limit(F);
  EXPECT_EQ(limited.share, 1.0);
  EXPECT_EQ(limited.F.f, F.f);
  EXPECT_EQ(limited.F.t, F.t);
}

TEST(WrenchLimiter, RefusesAForceLimitThatIsNotPositiveAndAllowsAtMost200N) {
  EXPECT_EQ(WrenchLimiter({.max_force_N = 1e6}).max_force_N(), 200.0);
  EXPECT_LE(WrenchLimiter({.max_force_N = 1e6}).Limit({.f = {0.0, 0.0, 500.0}, .t = {}}).F.f.norm(), 200.0);
  EXPECT_THROW(WrenchLimiter({.max_force_N = 0.0}), std::invalid_argument);
  EXPECT_THROW(WrenchLimiter({.max_force_N = kNan}), std::invalid_argument);
  EXPECT_THROW(WrenchLimiter({.max_torque_Nm = -1.0}), std::invalid_argument);
}

TEST(WrenchLimiter, AWrenchThatIsNotFiniteBecomesZero) {
  for (const double bad : {kNan, kInf, -kInf})
    for (int i = 0; i < 6; ++i) {
      Wrench F{.f = {1.0, 2.0, 3.0}, .t = {1.0, 2.0, 3.0}};
      (i < 3 ? F.f[i] : F.t[i - 3]) = bad;
      const LimitedWrench limited = WrenchLimiter({}).Limit(F);
      EXPECT_EQ(limited.share, 0.0);
      EXPECT_TRUE(limited.F.f.isZero(0.0) && limited.F.t.isZero(0.0));
    }
  EXPECT_LE(WrenchLimiter({}).Limit({.f = {kHuge, kHuge, kHuge}, .t = {}}).F.f.norm(), 200.0);
}

// An arm of seven joints with a random Jacobian and random gravity torques, of at most half the joints'
// limits: 320 Nm at joint 1 down to 40 Nm at joints 6 and 7, times `strength`.
struct DrawnArm {
  kinematics::JacobianN<7> J;
  kinematics::JointVectorN<7> g, tau_max;

  explicit DrawnArm(std::mt19937_64& random, double strength = 1.0) {
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (double& x : J.reshaped()) x = unit(random);
    tau_max << 320.0, 320.0, 176.0, 176.0, 110.0, 40.0, 40.0;
    tau_max *= strength;
    for (int i = 0; i < 7; ++i) g[i] = 0.5 * tau_max[i] * unit(random);
  }
  [[nodiscard]] kinematics::ForceCapability<7> Capability() const {
    return {J, g, tau_max, kinematics::GravityHelp::kNotCounted};
  }
  // torques that hold the arm while it exerts F
  [[nodiscard]] kinematics::JointVectorN<7> Torques(const Wrench& F) const {
    return g + J.topRows<3>().transpose() * F.f + J.bottomRows<3>().transpose() * F.t;
  }
};

TEST(WrenchLimiter, KeepsEachJointWithinItsTorqueLimitWithoutTurningTheWrench) {
  const WrenchLimiter limiter({.max_force_N = 200.0, .max_torque_Nm = 20.0});
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int by_arm = 0, by_cell = 0;
  for (int i = 0; i < 20'000; ++i) {
    const DrawnArm arm(random, i % 2 == 0 ? 1.0 : 10.0);
    const double size_N = 400.0 * std::abs(unit(random));
    const Wrench F{.f = size_N * Vector3(unit(random), unit(random), unit(random)),
                   .t = 5.0 * Vector3(unit(random), unit(random), unit(random))};
    const LimitedWrench limited = limiter.Limit(F, arm.Capability());
    const LimitedWrench cell = limiter.Limit(F);
    // 1e-9 N·m: rounding of sums of up to some thousand N·m
    ASSERT_TRUE(((arm.tau_max - arm.Torques(limited.F).cwiseAbs()).array() > -1e-9).all()) << "draw " << i;
    ASSERT_LE(limited.F.f.norm(), 200.0);
    ASSERT_LE(limited.F.t.norm(), 20.0);
    ASSERT_LT((limited.F.f - limited.share * F.f).norm(), 1e-12);
    ASSERT_LT((limited.F.t - limited.share * F.t).norm(), 1e-12);
    ASSERT_EQ(limited.share, std::min(cell.share, limited.arm_share)) << "the nearest limit, and no more";
    (limited.arm_share < cell.share ? by_arm : by_cell) += limited.share < 1.0 ? 1 : 0;
  }
  EXPECT_GT(by_arm, 1000);
  EXPECT_GT(by_cell, 1000);
}

TEST(WrenchLimiter, AWrenchThatTheArmCanHoldPassesBitForBit) {
  std::mt19937_64 random(3);
  const DrawnArm arm(random);
  const Wrench F{.f = {0.1, 0.2, 3.0}, .t = {0.1, 0.2, 0.3}};
  const LimitedWrench limited = WrenchLimiter({}).Limit(F, arm.Capability());
  EXPECT_EQ(limited.share, 1.0);
  EXPECT_EQ(limited.arm_share, 1.0);
  EXPECT_EQ(limited.F.f, F.f);
  EXPECT_EQ(limited.F.t, F.t);
}

TEST(WrenchLimiter, RendersNothingIfTheArmCannotHoldItsWeightOrAnInputIsNotFinite) {
  std::mt19937_64 random(4);
  const Wrench F{.f = {1.0, 2.0, 3.0}, .t = Vector3::Zero()};
  DrawnArm weak(random), unknown(random);
  weak.g[5] = 41.0;
  unknown.J(3, 3) = kNan;
  for (const DrawnArm* arm : {&weak, &unknown}) {
    const LimitedWrench limited = WrenchLimiter({}).Limit(F, arm->Capability());
    EXPECT_EQ(limited.arm_share, 0.0);
    EXPECT_EQ(limited.share, 0.0);
    EXPECT_TRUE(limited.F.f.isZero(0.0));
  }
  const LimitedWrench bad =
      WrenchLimiter({}).Limit({.f = {kInf, 0.0, 0.0}, .t = {}}, DrawnArm(random).Capability());
  EXPECT_EQ(bad.share, 0.0);
  EXPECT_TRUE(bad.F.f.isZero(0.0));
}

// At 0.25 m/s a contact of 20 N/mm raises the force by 5 N in a tick, and by 6.25 N with its damping. The
// trip's limit is 7.5 N in a tick.
TEST(WrenchRateTrip, PassesANewContactAtFullSpeedWithItsDamping) {
  WrenchRateTrip trip(20e3, 0.25);
  EXPECT_EQ(trip.max_rate_N_per_s(), 7500.0);
  double depth_m = 0.0;
  for (int i = 0; i < 40; ++i) {
    depth_m += 0.25e-3;
    ASSERT_FALSE(trip.Check({0.0, 0.0, 1.25 * 20e3 * depth_m}, 0.001)) << "tick " << i;
  }
}

TEST(WrenchRateTrip, TripsOnASuddenRiseButNotOnASuddenFall) {
  WrenchRateTrip trip(20e3, 0.25);
  EXPECT_TRUE(trip.Check({0.0, 0.0, 8.0}, 0.001)) << "from nothing to 8 N in a tick";
  trip.Reset();
  for (int i = 1; i <= 30; ++i) ASSERT_FALSE(trip.Check({0.0, 0.0, 6.0 * i}, 0.001));
  EXPECT_FALSE(trip.Check({0.0, 0.0, 40.0}, 0.001)) << "a fall by 140 N is never held back";
  EXPECT_FALSE(trip.Check(Vector3::Zero(), 0.001));
}

TEST(WrenchRateTrip, TripsOnAForceThatTurnsOrReverses) {
  WrenchRateTrip trip(20e3, 0.25);
  for (int i = 1; i <= 20; ++i) ASSERT_FALSE(trip.Check({0.0, 0.0, 5.0 * i}, 0.001));
  EXPECT_TRUE(trip.Check({0.0, 0.0, -100.0}, 0.001)) << "same size, reversed";
  trip.Reset();
  for (int i = 1; i <= 20; ++i) ASSERT_FALSE(trip.Check({0.0, 0.0, 5.0 * i}, 0.001));
  EXPECT_TRUE(trip.Check({100.0 * std::sin(0.2), 0.0, 100.0 * std::cos(0.2)}, 0.001))
      << "turned by 0.2 rad: 20 N";
}

TEST(WrenchRateTrip, TripsOnAForceThatIsNotFiniteOrHuge) {
  WrenchRateTrip trip(20e3, 0.25);
  EXPECT_TRUE(trip.Check({kNan, 0.0, 0.0}, 0.001));
  EXPECT_TRUE(trip.Check({kHuge, kHuge, 0.0}, 0.001));
  EXPECT_TRUE(trip.Check({-kHuge, kHuge, 0.0}, 0.001)) << "after a huge one, too";
}

TEST(SensorForceTrip, TripsAfterItsNumberOfConsecutiveTicks) {
  SensorForceTrip trip({.margin_N = 50.0, .ticks = 3}, 200.0);
  EXPECT_EQ(trip.level_N(), 250.0);
  EXPECT_FALSE(trip.Check(251.0));
  EXPECT_FALSE(trip.Check(251.0));
  EXPECT_FALSE(trip.Check(249.0)) << "the count starts anew";
  EXPECT_FALSE(trip.Check(251.0));
  EXPECT_FALSE(trip.Check(kNan)) << "what is not a number counts as beyond";
  EXPECT_TRUE(trip.Check(251.0));
}

TEST(TwistLimiter, ScalesTheWholeTwist) {
  const TwistLimitParams params{.max_speed_m_per_s = 0.2, .max_turn_rad_per_s = 1.0};
  const Twist V{.v = {0.0, 0.6, 0.8}, .w = {0.5, 0.0, 0.0}};
  const LimitedTwist limited = LimitTwist(V, params);
  EXPECT_NEAR(limited.share, 0.2, 1e-15);
  EXPECT_TRUE(limited.V.v.isApprox(0.2 * V.v, 1e-14));
  EXPECT_TRUE(limited.V.w.isApprox(0.2 * V.w, 1e-14));
  EXPECT_NEAR(LimitTwist({.v = {0.1, 0.0, 0.0}, .w = {0.0, 4.0, 0.0}}, params).V.v.x(), 0.025, 1e-15);
  EXPECT_TRUE(LimitTwist({.v = {kInf, 0.0, 0.0}, .w = Vector3::Zero()}, params).V.v.isZero(0.0));
}

// Oracle: the sum of the steps that a stop makes, tick by tick.
TEST(BrakingSpeed, AStopFromThisSpeedEndsWithinTheDistance) {
  const double a = 3.0, dt_s = 0.001;
  for (const double distance_m : {1e-6, 1e-4, 1e-3, 0.01, 0.1}) {
    const double v0 = BrakingSpeed(distance_m, a, dt_s);
    double travelled_m = dt_s * v0;
    for (double v = v0 - a * dt_s; v > 0.0; v -= a * dt_s) travelled_m += dt_s * v;
    EXPECT_LE(travelled_m, distance_m);
    if (distance_m >= 0.01) {
      EXPECT_GT(travelled_m, 0.97 * distance_m) << "and does not waste it";
    }
  }
  EXPECT_EQ(BrakingSpeed(0.0, a, dt_s), 0.0);
  EXPECT_EQ(BrakingSpeed(-1.0, a, dt_s), 0.0);
  EXPECT_EQ(BrakingSpeed(kNan, a, dt_s), 0.0);
}

TEST(Limits, DoNotAllocate) {
  const WrenchLimiter limiter({});
  WrenchRateTrip trip(20e3, 0.25);
  std::mt19937_64 random(5);
  const kinematics::ForceCapability<7> arm = DrawnArm(random).Capability();
  rt::CheckedNoAllocScope no_alloc;
  const LimitedWrench limited = limiter.Limit({.f = {300.0, 0.0, 0.0}, .t = {1.0, 0.0, 0.0}}, arm);
  const bool tripped = trip.Check(limited.F.f, 0.001);
  const LimitedTwist twist = LimitTwist({.v = {1.0, 0.0, 0.0}, .w = {1.0, 0.0, 0.0}}, {});
  no_alloc.End();
  EXPECT_TRUE(tripped && twist.share < 1.0);
}

}  // namespace
}  // namespace osteon::safety
