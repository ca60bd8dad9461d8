#include "hil/operator/operator_hand.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "hil/operator/hand_script.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/hil/operator/hand_samples.h"

// Tests the simulated operator: the reaming script over time, and the wrench of the hand that follows the
// script.

namespace osteon::hil {
namespace {

HandScript Reaming(double seconds = 10.0) {
  return MakeReamingScript({.X_WC = TiltedCup(), .tool_yaw_rad = 0.4, .seconds = seconds});
}

TEST(HandScript, StartsAboveTheCupWithTheFeedIntoIt) {
  const Pose X_WC = TiltedCup();
  const HandTarget start = Reaming().Sample(0.0);
  EXPECT_TRUE(start.X_WT.linear().col(2).isApprox(-X_WC.linear().col(2), 1e-14));
  EXPECT_TRUE(HeadCenter(start.X_WT).isApprox(X_WC * Vector3(0, 0, 0.040), 1e-14));
  EXPECT_EQ(start.grip, 0.0);
  const HandTarget end = Reaming().Sample(100.0);
  EXPECT_TRUE(HeadCenter(end.X_WT).isApprox(X_WC * Vector3(0, 0, 0.030), 1e-14));
}

TEST(HandScript, ATenSecondScriptHasTheDocumentedPhases) {
  const HandScript script = Reaming();
  EXPECT_NEAR(script.duration_s(), 10.0, 1e-12);
  EXPECT_NEAR(script.Sample(1.0).height_m, 0.0, 1e-12);        // the approach has ended
  EXPECT_NEAR(script.Sample(1.7).force_limit_N, 120.0, 1e-9);  // full force
  EXPECT_NEAR(script.Sample(5.0).height_m, -0.010 - 0.060,
              1e-12);  // retracted so far that the spring no longer reaches the bone with 120 N
  EXPECT_NEAR(script.Sample(8.8).force_limit_N, 120.0, 1e-9);
  EXPECT_NEAR(script.Sample(9.2).force_limit_N, 20.0, 1e-9);
  EXPECT_STREQ(script.PhaseName(0.5), "approach");
  EXPECT_STREQ(script.PhaseName(5.0), "whirlwind");
  EXPECT_STREQ(script.PhaseName(11.0), "done");
}

TEST(HandScript, PressesStraightAlongTheAxisWithoutATilt) {
  ReamingScriptParams params;
  params.tilt_rad = 0.0;
  const HandScript script = MakeReamingScript(params);
  EXPECT_NEAR(script.duration_s(), 10.0, 1e-12);
  EXPECT_STREQ(script.PhaseName(5.0), "press");
  EXPECT_NEAR(script.Sample(5.0).force_limit_N, 120.0, 1e-9);
  const Matrix3 upright = script.Sample(0.0).X_WT.linear();
  for (double t = 0.0; t <= 10.0; t += 0.1)
    EXPECT_LT((script.Sample(t).X_WT.linear() - upright).norm(), 1e-14) << "at " << t << " s";
}

TEST(HandScript, WhirlwindTiltsTenDegreesAboutTheHeadsCentreInTwoSeconds) {
  const HandScript script = Reaming();
  const Pose X_WC = TiltedCup();
  const Vector3 n = X_WC.linear().col(2);
  for (double t = 0.0; t <= 10.0; t += 0.05) {
    // the head's centre must stay on the axis all the time
    const Vector3 p_C = X_WC.inverse() * HeadCenter(script.Sample(t).X_WT);
    EXPECT_LT(p_C.head<2>().norm(), 1e-14);
  }
  for (double t = 2.6; t <= 6.0; t += 0.1) {
    const Vector3 z = script.Sample(t).X_WT.linear().col(2);
    EXPECT_NEAR(std::acos(-z.dot(n)), 10.0 * std::numbers::pi / 180.0, 1e-9);
    EXPECT_LT((script.Sample(t + 2.0).X_WT.linear().col(2) - z).norm(),
              1e-9);  // one period of the tilt later
    EXPECT_NEAR((script.Sample(t + 1.0).X_WT.linear().col(2) + z).normalized().dot(-n), 1.0,
                1e-9);  // half a period later the tilt is opposite
  }
}

// Compares the velocity with the central difference of the pose. The error is h^2/6 of the third derivative,
// with the step h: about 1e-8 here.
TEST(HandScript, VelocityIsTheDerivativeOfThePose) {
  const double h = 1e-5;
  for (const double seconds : {1.0, 10.0}) {
    const HandScript script = Reaming(seconds);
    for (double t = 0.013 * seconds; t < seconds; t += 0.029 * seconds) {
      const HandTarget a = script.Sample(t - h), b = script.Sample(t + h), m = script.Sample(t);
      EXPECT_LT(((b.X_WT.translation() - a.X_WT.translation()) / (2 * h) - m.V_WT.v).norm(), 1e-6) << t;
      EXPECT_LT((LogRotation(b.X_WT.linear() * a.X_WT.linear().transpose()) / (2 * h) - m.V_WT.w).norm(),
                1e-6)
          << t;
    }
  }
}

// The slope of the velocity must not jump when the phase changes. With a blend that is only C1, over the
// distance d in the time T, it would jump by 6 d / T^2: 2.6 m/s^2 at the end of unloading. With the quintic,
// the jerk (60 d / T^3 = 40 m/s^3) over the distance 4 h between the samples changes the slope by 2e-3 m/s^2
// only.
TEST(HandScript, TargetsAreTwiceContinuouslyDifferentiable) {
  const HandScript script = Reaming();
  const double h = 1e-5;
  double boundary = 0.0;
  for (const HandPhase& phase : script.phases()) {
    const auto slope = [&](double t0, double t1, auto get) {
      return Vector3((get(t1) - get(t0)) / (t1 - t0));
    };
    const auto v = [&](double t) { return script.Sample(t).V_WT.v; };
    const auto w = [&](double t) { return script.Sample(t).V_WT.w; };
    if (boundary > 0.0) {
      const double l0 = boundary - 2 * h, l1 = boundary - h, r0 = boundary + h, r1 = boundary + 2 * h;
      EXPECT_LT((slope(r0, r1, v) - slope(l0, l1, v)).norm(), 5e-3) << phase.name;
      EXPECT_LT((slope(r0, r1, w) - slope(l0, l1, w)).norm(), 5e-3) << phase.name;
      const auto force = [&](double t) { return Vector3(script.Sample(t).force_limit_N, 0, 0); };
      EXPECT_LT(slope(l1, r0, force).norm(), 1e-3) << phase.name;  // the hand rests there
    }
    boundary += phase.duration_s;
  }
}

TEST(HandScript, TargetsStayBelowTheirSpeedLimitForAnyDuration) {
  for (const double seconds : {0.1, 0.3, 1.0, 3.0, 10.0, 600.0}) {
    const HandScript script = Reaming(seconds);
    EXPECT_NEAR(script.duration_s(), seconds, 1e-9 * seconds);
    const Vector3 n = TiltedCup().linear().col(2);
    for (double u = 0.0; u <= 1.0; u += 1e-3) {
      const HandTarget target = script.Sample(u * seconds);
      const Vector3 v_head = target.V_WT.v + target.V_WT.w.cross(-0.025 * target.X_WT.linear().col(2));
      ASSERT_LE(std::abs(v_head.dot(n)), 0.2 + 1e-9);
      ASSERT_LE(target.V_WT.w.norm(), 0.5 + std::numbers::pi * 0.175 + 1e-9);
      ASSERT_LE(target.force_limit_N, 120.0);
    }
  }
  EXPECT_THROW((void)Reaming(0.0), std::invalid_argument);
  EXPECT_THROW((void)Reaming(-1.0), std::invalid_argument);
  EXPECT_THROW((void)Reaming(std::nan("")), std::invalid_argument);
}

TEST(OperatorHand, PullsTheToolBackToItsTarget) {
  OperatorHand hand({}, Hold());
  hand.Reset();
  Pose X_WT = Hold().Sample(0.0).X_WT;
  const Vector3 d(1e-3, -2e-3, 0.5e-3);
  X_WT.translation() += d;
  Wrench F = hand.Step(0.1, 1e-3, X_WT, {});
  EXPECT_TRUE(F.f.isApprox(-2000.0 * d, 1e-9));

  X_WT = Hold().Sample(0.0).X_WT;
  const Vector3 r(0.02, -0.01, 0.03), p_T_head = -0.025 * X_WT.linear().col(2);
  X_WT.linear() = ExpRotation(r) * X_WT.linear();
  X_WT.translation() += p_T_head - ExpRotation(r) * p_T_head;  // rotates about the head's centre
  F = hand.Step(0.1, 1e-3, X_WT, {});
  EXPECT_LT(F.f.norm(), 1e-9);
  EXPECT_TRUE(F.t.isApprox(-20.0 * r, 1e-9));
}

// The hand pulls at the head's centre, but its wrench is given at the tool's origin To. Force and torque at
// To must do the same virtual work as the force alone at the head's centre.
TEST(OperatorHand, WrenchAtTheToolsOriginEqualsTheForceAtTheHeadsCentre) {
  OperatorHand hand({}, Hold());
  hand.Reset();
  Pose X_WT = Hold().Sample(0.0).X_WT;
  X_WT.translation() +=
      Vector3(1e-3, 2e-3, 3e-3);  // a pure translation, so there is no torque at the head's centre
  const Wrench F = hand.Step(0.1, 1e-3, X_WT, {});
  for (int i = 0; i < 3; ++i) {
    const Vector3 w = Vector3::Unit(i);
    const Vector3 v_head = w.cross(Vector3(HeadCenter(X_WT) - X_WT.translation()));
    EXPECT_NEAR(F.t.dot(w), F.f.dot(v_head), 1e-12);
  }
}

TEST(OperatorHand, PressesWithTheScriptedForceAgainstAFixedTool) {
  const HandScript script = Reaming();
  OperatorHand hand({}, script);
  hand.Reset();
  const Vector3 n = TiltedCup().linear().col(2);
  Pose X_WT = script.Sample(0.0).X_WT;
  X_WT.translation() -= 0.042 * n;  // from the start at the height 40 mm to the height -2 mm
  for (int k = 1; k <= 10000; ++k) {
    const double t = k * 1e-3;
    const Wrench F = hand.Step(t, 1e-3, X_WT, {});
    if (t > 1.7 && t < 8.8) {
      ASSERT_NEAR(F.f.dot(n), -120.0, 1e-9) << t;
    }
    // The tool is upright while the target is tilted by 10 deg and turns about the axis. So the torques of
    // spring and damper are perpendicular to each other.
    if (t > 2.6 && t < 7.9) {
      const double spring = 20.0 * 0.174533, damper = 0.8 * std::numbers::pi * std::sin(0.174533);
      ASSERT_NEAR((F.t - (X_WT.translation() - HeadCenter(X_WT)).cross(-F.f)).norm(),
                  std::hypot(spring, damper), 2e-3);
    }
  }
}

// The tool is moved at random, farther and faster than the hand can follow, and the hand trembles. Every
// bound must hold in every tick.
TEST(OperatorHand, ForcesAreBoundedWhateverTheToolDoes) {
  const Vector3 n = TiltedCup().linear().col(2);
  std::mt19937 random(99);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const auto vector = [&](double s) { return Vector3(s * Vector3(u(random), u(random), u(random))); };
  for (const double seconds : {0.1, 2.0, 10.0}) {
    const HandScript script = Reaming(seconds);
    OperatorHand hand({.tremor_N = 3.0}, script);
    hand.Reset();
    for (int k = 1; k <= 4000; ++k) {
      const double t = seconds * k / 3500.0, scale = std::pow(10.0, 3.0 * u(random) - 2.0);
      Pose X_WT = script.Sample(t).X_WT;
      X_WT.translation() += vector(scale);
      X_WT.linear() = ExpRotation(vector(scale)) * X_WT.linear();
      const Wrench F = hand.Step(t, 1e-3, X_WT, {.v = vector(scale), .w = vector(10 * scale)});
      ASSERT_TRUE(F.f.allFinite() && F.t.allFinite());
      ASSERT_LE(std::abs(F.f.dot(n)), script.Sample(t).force_limit_N + 1e-9);
      ASSERT_LE(F.f.norm(), 150.0 + 1e-9);
      ASSERT_LE(F.t.norm(), 10.0 + 1e-9);
    }
  }
}

// With neither spring nor damper, a handle that accelerates constantly feels only the inertia of the hand's
// mass.
TEST(OperatorHand, AddsTheInertiaOfItsMass) {
  OperatorHand hand(
      {.stiffness_N_per_m = 0, .damping_Ns_per_m = 0, .stiffness_Nm_per_rad = 0, .damping_Nms_per_rad = 0},
      Hold());
  hand.Reset();
  const Vector3 a(2.0, -1.0, 3.0), alpha(1.0, 2.0, -0.5);
  const Pose X_WT = Hold().Sample(0.0).X_WT;
  const Vector3 p_T_head = HeadCenter(X_WT) - X_WT.translation();
  Wrench F;
  for (int k = 1; k <= 100; ++k)
    F = hand.Step(k * 1e-3, 1e-3, X_WT, {.v = a * (k * 1e-3), .w = alpha * (k * 1e-3)});
  // after 20 time constants only the inertia of the mass remains: f = -m a_head, and the torque t about T is
  // -I alpha + r x f
  const Vector3 f = -1.5 * (a + alpha.cross(p_T_head));
  EXPECT_LT((F.f - f).norm(), 1e-6);
  EXPECT_LT((F.t - (-0.01 * alpha + p_T_head.cross(f))).norm(), 1e-6);
}

// For any motion of the handle and any filter time, the hand's mass must never return more energy than it
// received.
TEST(OperatorHand, MassIsPassive) {
  std::mt19937 random(5);
  std::normal_distribution<double> gauss;
  for (const double tau : {1e-4, 5e-3, 0.1}) {
    OperatorHand hand({.stiffness_N_per_m = 0,
                       .damping_Ns_per_m = 0,
                       .stiffness_Nm_per_rad = 0,
                       .damping_Nms_per_rad = 0,
                       .grip_time_s = tau,
                       .max_force_N = 1e9,
                       .max_torque_Nm = 1e9},
                      Hold(1e9));
    hand.Reset();
    const Pose X_WT = Hold().Sample(0.0).X_WT;
    double absorbed_J = 0.0;
    for (int k = 1; k <= 5000; ++k) {
      const Vector3 v = 0.1 * Vector3(gauss(random), gauss(random), gauss(random));
      absorbed_J -= hand.Step(k * 1e-3, 1e-3, X_WT, {.v = v}).f.dot(v) * 1e-3;
      ASSERT_GE(absorbed_J, 0.0);
    }
  }
}

TEST(OperatorHand, TremorIsSeededAndBounded) {
  const auto run = [](double tremor_N, std::uint64_t seed) {
    OperatorHand hand({.tremor_N = tremor_N, .tremor_seed = seed}, Hold());
    hand.Reset();
    std::vector<Vector3> f;
    for (int k = 0; k < 1000; ++k) f.push_back(hand.Step(k * 1e-3, 1e-3, Hold().Sample(0.0).X_WT, {}).f);
    return f;
  };
  EXPECT_EQ(run(2.0, 3), run(2.0, 3));
  EXPECT_NE(run(2.0, 3), run(2.0, 4));
  double peak = 0.0;
  for (const Vector3& f : run(2.0, 3)) peak = std::max(peak, f.cwiseAbs().maxCoeff());
  EXPECT_LE(peak, 2.0);
  EXPECT_GT(peak, 0.5);
  for (const Vector3& f : run(0.0, 3)) EXPECT_LT(f.norm(), 1e-12);
}

TEST(OperatorHand, DoesNotAllocate) {
  const HandScript script = Reaming();
  OperatorHand hand({.tremor_N = 1.0}, script);
  const Pose X_WT = script.Sample(0.0).X_WT;
  rt::CheckedNoAllocScope no_alloc;
  hand.Reset();
  for (int k = 0; k < 100; ++k) (void)hand.Step(k * 0.1, 1e-3, X_WT, {});
}

// The script's work is done at a height of -2 mm. The hand presses with its whole limit of 60 N down to 0.3
// mm above that height, with half of it at 0.15 mm above, and not at all below. It reacts with a lag of 0.25
// s. A pull out of the bone is not reduced.
TEST(OperatorHand, StopsPushingWhereItSeesTheWorkDone) {
  // the hand's force into the bone after `seconds`, with the head at rest at this height
  const auto push_N = [](double head_height_m, double seconds, double target_m, double give_m_per_N) {
    const HandKey key{.height_m = target_m,
                      .force_limit_N = 60.0,
                      .tilt_rad = 0.0,
                      .grip = 1.0,
                      .done_height_m = -0.002,
                      .give_m_per_N = give_m_per_N};
    const HandScript script(TiltedCup(), 0.025, 0.0, 2.0, key, {{"push", 10.0, key}});
    OperatorHand hand({}, script);
    hand.Reset();
    Pose X_WT = script.Sample(0.0).X_WT;
    const Vector3 n = TiltedCup().linear().col(2);
    X_WT.translation() += (head_height_m - target_m) * n;
    double f_N = 0.0;
    for (int k = 0; k < static_cast<int>(1e3 * seconds); ++k)
      f_N = -n.dot(hand.Step(1e-3 * k, 1e-3, X_WT, {}).f);
    return f_N;
  };
  constexpr double kFarBelow_m = -0.05;
  EXPECT_NEAR(push_N(0.0, 3.0, kFarBelow_m, 0.0), 60.0, 1e-3) << "2 mm above";
  EXPECT_NEAR(push_N(-0.00185, 3.0, kFarBelow_m, 0.0), 30.0, 1e-2);
  EXPECT_NEAR(push_N(-0.0025, 3.0, kFarBelow_m, 0.0), 0.0, 1e-2) << "too deep";
  EXPECT_NEAR(push_N(-0.0025, 0.25, kFarBelow_m, 0.0), 60.0 * std::exp(-1.0), 0.2)
      << "after the lag of a person who looks";
  EXPECT_NEAR(push_N(-0.0045, 3.0, kFarBelow_m, 5e-5), 60.0, 1e-3)
      << "60 N over 20 N/mm: the tool that cuts is 3 mm higher";
  EXPECT_NEAR(push_N(-0.0025, 3.0, 0.03, 0.0), -60.0, 1e-3) << "the retreat is not weaker";
}

TEST(OperatorHand, RefusesParametersOutOfRange) {
  const auto make = [](const OperatorHandParams& p) { OperatorHand hand(p, Hold()); };
  EXPECT_NO_THROW(make({}));
  EXPECT_THROW(make({.stiffness_N_per_m = -1}), std::invalid_argument);
  EXPECT_THROW(make({.grip_time_s = 0}), std::invalid_argument);
  EXPECT_THROW(make({.max_force_N = std::nan("")}), std::invalid_argument);
  const HandKey key;
  EXPECT_THROW(HandScript({}, 0.0, 0.0, 2.0, key, {}), std::invalid_argument);
  EXPECT_THROW(HandScript({}, 0.025, 0.0, 2.0, key, {{"p", 0.0, key}}), std::invalid_argument);
  EXPECT_THROW((void)MakeReamingScript({.push_force_N = -120}), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::hil
