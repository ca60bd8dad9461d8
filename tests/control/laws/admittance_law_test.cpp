#include "control/laws/admittance_law.h"

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"

// Tests the admittance law, which turns the hand's force into motion of the virtual tool by the tool's mass
// and damping.

namespace osteon::control {
namespace {

constexpr double kDt_s = 0.001;

// Oracle: the speed after a time t is v(t) = F/b (1 - exp(-b t/m)), with the force F and the default mass m
// and damping b.
TEST(AdmittanceLaw, AConstantPushApproachesTheSpeedForceOverDamping) {
  const AdmittanceParams params;
  AdmittanceState state;
  const double dt_s = 1e-5, force_N = 12.0, m_kg = 3.0, b_Ns_per_m = 20.0;
  double max_error = 0.0;  // largest error of the speed [m/s]
  for (int i = 1; i <= 100'000; ++i) {
    ASSERT_TRUE(StepAdmittance(params, {.f = {0.0, force_N, 0.0}, .t = Vector3::Zero()}, dt_s, state));
    const double v = force_N / b_Ns_per_m * (1.0 - std::exp(-b_Ns_per_m * i * dt_s / m_kg));
    max_error = std::max(max_error, std::abs(state.V_WT.v.y() - v));
  }
  EXPECT_LT(max_error, force_N / m_kg * dt_s) << "first order: one step's worth of acceleration";
  EXPECT_GT(max_error, 0.0) << "the oracle is independent of the code under test";
}

TEST(AdmittanceLaw, MassesActAlongTheAxesOfTheTool) {
  AdmittanceParams params;
  params.mass_kg = {1.0, 2.0, 4.0};
  const Matrix3 R_WT = ExpRotation({0.5, 1.0, -0.7});
  for (int axis = 0; axis < 3; ++axis) {
    Pose X_WT = Pose::Identity();
    X_WT.linear() = R_WT;
    Twist V;
    ASSERT_TRUE(NextTwist(
        params, {.X_WT = X_WT, .F_T_W = {.f = 10.0 * R_WT.col(axis), .t = Vector3::Zero()}, .dt_s = kDt_s},
        V));
    const double m = params.mass_kg[axis];
    const Vector3 expected = kDt_s / m * 10.0 / (1.0 + kDt_s * 20.0 / m) * R_WT.col(axis);
    EXPECT_TRUE(V.v.isApprox(expected, 1e-13)) << "axis " << axis;
  }
}

TEST(AdmittanceLaw, WithoutAForceTheSpeedOnlyFalls) {
  AdmittanceParams params;
  params.inertia_kg_m2 = {0.1, 0.2, 0.3};
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int run = 0; run < 50; ++run) {
    AdmittanceState state;
    state.V_WT = {.v = {normal(random), normal(random), normal(random)},
                  .w = {normal(random), normal(random), normal(random)}};
    const auto speed = [&] { return state.V_WT.v.norm(); };
    double last = speed();
    for (int i = 0; i < 500; ++i) {
      ASSERT_TRUE(StepAdmittance(params, {}, kDt_s, state));
      ASSERT_LT(speed(), last);
      last = speed();
    }
  }
}

TEST(AdmittanceLaw, RotationStaysOrthonormalOverAnHourOfTurning) {
  Pose X_WT = Pose::Identity();
  for (int i = 0; i < 3'600'000; ++i)
    X_WT = IntegratePose(X_WT, {.v = Vector3::Zero(), .w = {0.7, -0.9, 0.4}}, kDt_s);
  EXPECT_LT((X_WT.linear() * X_WT.linear().transpose() - Matrix3::Identity()).norm(), 1e-14);
}

// Oracle: a constant rotation about one axis equals one rotation by the whole angle.
TEST(AdmittanceLaw, IntegratePoseIsExactForAConstantTurn) {
  Pose X_WT = Pose::Identity();
  const Vector3 w(0.3, -0.2, 0.5);
  for (int i = 0; i < 1000; ++i) X_WT = IntegratePose(X_WT, {.v = {0.1, 0.0, 0.0}, .w = w}, kDt_s);
  EXPECT_LT((X_WT.linear() - ExpRotation(w)).norm(), 1e-13);
  EXPECT_NEAR(X_WT.translation().x(), 0.1, 1e-13);
}

TEST(AdmittanceLaw, KeepsItsStateAndReportsInputThatIsNotFinite) {
  const AdmittanceState before{.X_WT = Pose::Identity(),
                               .V_WT = {.v = {0.1, 0.2, 0.3}, .w = {0.0, 0.1, 0.0}}};
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    AdmittanceState state = before;
    EXPECT_FALSE(StepAdmittance({}, {.f = {0.0, bad, 0.0}, .t = Vector3::Zero()}, kDt_s, state));
    EXPECT_FALSE(StepAdmittance({}, {.f = Vector3::Zero(), .t = {bad, 0.0, 0.0}}, kDt_s, state));
    EXPECT_EQ(state.V_WT.v, before.V_WT.v);
    EXPECT_EQ(state.X_WT.matrix(), before.X_WT.matrix());
  }
}

TEST(AdmittanceLaw, DeadZoneIsContinuousAndKeepsTheDirection) {
  AdmittanceParams params;
  params.dead_zone_N = 2.0;
  params.dead_zone_Nm = 0.1;
  EXPECT_TRUE(SubtractDeadZone(params, {.f = {1.2, 1.6, 0.0}, .t = {0.0, 0.0, 0.1}}).f.isZero(0.0))
      << "|f| = 2";
  const Wrench out = SubtractDeadZone(params, {.f = {3.0, 4.0, 0.0}, .t = {0.0, 0.0, 0.3}});
  EXPECT_TRUE(out.f.isApprox(Vector3(1.8, 2.4, 0.0), 1e-14));
  EXPECT_NEAR(out.t.z(), 0.2, 1e-15);
}

TEST(AdmittanceLaw, RefusesGainsThatAreNotPositive) {
  AdmittanceParams params;
  params.mass_kg.y() = 0.0;
  EXPECT_THROW(Validate(params), std::invalid_argument);
  params = {};
  params.damping_Nms_per_rad.z() = -1.0;
  EXPECT_THROW(Validate(params), std::invalid_argument);
  EXPECT_NO_THROW(Validate(AdmittanceParams{}));
}

TEST(AdmittanceLaw, DoesNotAllocate) {
  AdmittanceState state;
  rt::CheckedNoAllocScope no_alloc;
  const bool ok = StepAdmittance({}, {.f = {1.0, 2.0, 3.0}, .t = {0.1, 0.2, 0.3}}, kDt_s, state);
  no_alloc.End();
  EXPECT_TRUE(ok);
}

}  // namespace
}  // namespace osteon::control
