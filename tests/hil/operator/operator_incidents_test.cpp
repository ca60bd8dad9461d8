#include "hil/operator/operator_incidents.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "hil/operator/operator_hand.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/hil/operator/hand_samples.h"

// Tests incidents of the simulated operator: a grip that stiffens, a clamped handle, a startled release.

namespace osteon::hil {
namespace {

constexpr double kDt_s = 1e-3;  // control period

HandIncidents IncidentsOf(std::initializer_list<HandIncident> list) {
  HandIncidents incidents;
  for (const HandIncident& incident : list) incidents.list.at(incidents.count++) = incident;
  return incidents;
}

// The pose moved by a vector [m].
Pose Moved(Pose X, const Vector3& by) {
  X.translation() += by;
  return X;
}

// A virtual tool that does not rotate: M v' + D v = f_hand + f_load. By default it is at rest at the hand's
// target when the test begins.
struct FreeTool {
  double mass_kg{3.0}, damping_Ns_per_m{20.0};
  Vector3 x{Vector3::Zero()}, v{Vector3::Zero()};  // offset from the target [m]; velocity [m/s]
  Vector3 f_hand{Vector3::Zero()};

  // Runs one period at the time t. The hand's force and the load f_load [N] act on the tool.
  void Step(OperatorHand& hand, double t, const Vector3& f_load) {
    f_hand = hand.Step(t, kDt_s, Moved(Hold().Sample(0.0).X_WT, x), {.v = v}).f;
    v = (v + kDt_s / mass_kg * (f_hand + f_load)) / (1.0 + kDt_s * damping_Ns_per_m / mass_kg);
    x += kDt_s * v;
  }
};

// Offset [m] at the time t of a tool in strong, smooth motion without a period.
Vector3 Shaken(double t) {
  return {4e-3 * std::sin(21 * t), 3e-3 * std::sin(13 * t + 1), 5e-3 * std::sin(34 * t + 2)};
}
// Time derivative of Shaken(t) [m/s].
Vector3 ShakenSpeed(double t) {
  return {84e-3 * std::cos(21 * t), 39e-3 * std::cos(13 * t + 1), 170e-3 * std::cos(34 * t + 2)};
}

// The target is out of reach, the tool is shaken, and all bounds of the hand are active. The hand's wrench
// must not jump when the spring stiffens, nor when the spring returns to normal.
TEST(GripStep, ChangesTheSpringWithoutAStepInTheWrench) {
  const HandScript script = Hold(20.0, -0.05);
  const OperatorHandParams plain{.damping_Ns_per_m = 30.0, .tremor_N = 1.0};
  OperatorHandParams stepped = plain;
  const HandSpring stiff{.stiffness_N_per_m = 6000.0,
                         .damping_Ns_per_m = 80.0,
                         .stiffness_Nm_per_rad = 200.0,
                         .damping_Nms_per_rad = 3.0};
  stepped.incidents = IncidentsOf({GripStep{.begin_s = 0.5, .end_s = 0.9, .return_s = 0.2, .spring = stiff}});
  OperatorHand hand(plain, script),
      gripping(stepped, script);  // a hand without the incident, and one with it
  hand.Reset();
  gripping.Reset();
  const Pose X_WT = Hold().Sample(0.0).X_WT;
  const auto tool = [&](double t) {
    Pose X = Moved(X_WT, Shaken(t));
    X.linear() = ExpRotation(10.0 * Shaken(t)) * X.linear();
    return X;
  };
  Wrench before;
  double largest_step = 0.0, largest_torque_step = 0.0;
  for (int k = 1; k <= 1300; ++k) {
    const double t = k * kDt_s;
    const Twist V{.v = ShakenSpeed(t), .w = 10.0 * ShakenSpeed(t)};
    const Wrench a = hand.Step(t, kDt_s, tool(t), V), b = gripping.Step(t, kDt_s, tool(t), V);
    if (k < 500 || k >= 1100) {
      ASSERT_EQ(a.f, b.f) << t;
      ASSERT_EQ(a.t, b.t) << t;
    }
    if (k == 500) {  // the forces are equal, but summed in another order
      EXPECT_LT((a.f - b.f).norm(), 1e-9);
      EXPECT_LT((a.t - b.t).norm(), 1e-9);
    }
    if (k > 501) {
      largest_step = std::max(largest_step, (b.f - before.f).norm());
      largest_torque_step = std::max(largest_torque_step, (b.t - before.t).norm());
    }
    before = b;
  }
  // in one tick, the stiff spring changes the force by 1.2 N at 0.2 m/s, and damper and mass by 0.7 N at 6
  // m/s^2. Without care, the change of the spring would add the 80 N that the script's limit cuts off
  EXPECT_LT(largest_step, 2.5);
  EXPECT_LT(largest_torque_step, 0.6);
}

// A tool at rest under a load must not move when the hand stiffens, nor when it relaxes again.
TEST(GripStep, DoesNotMoveATool) {
  const Vector3 load(6.0, -3.0, 4.0);
  OperatorHand hand({.stiffness_N_per_m = 300.0,
                     .incidents = IncidentsOf({GripStep{.begin_s = 0.5, .end_s = 1.0, .return_s = 0.3}})},
                    Hold());
  hand.Reset();
  FreeTool tool{.x = load / 300.0};
  for (int k = 1; k <= 2000; ++k) {
    tool.Step(hand, k * kDt_s, load);
    ASSERT_LT((tool.x - load / 300.0).norm(), 1e-12) << k;
  }
}

// After the grip step, the hand must resist with the new spring in all directions, although the script limits
// the force along the axis to 20 N.
TEST(GripStep, ResistsWithTheNewSpringInAllDirections) {
  const HandScript script = Hold(20.0, -0.05);
  OperatorHand hand(
      {.stiffness_N_per_m = 300.0,
       .mass_kg = 0.0,
       .incidents = IncidentsOf({GripStep{.begin_s = 0.1, .spring = {.stiffness_N_per_m = 6000.0}}})},
      script);
  hand.Reset();
  const Pose X_WT = Moved(Hold().Sample(0.0).X_WT, {1e-3, 0, 0});
  const Vector3 f = hand.Step(0.1, kDt_s, X_WT, {}).f;
  for (int i = 0; i < 3; ++i)
    for (const double d_m : {-2e-3, 3e-3}) {
      const Vector3 d = d_m * Vector3::Unit(i);
      EXPECT_LT((hand.Step(10.0, kDt_s, Moved(X_WT, d), {}).f - (f - 6000.0 * d)).norm(), 1e-9);
    }
  EXPECT_NEAR(hand.Step(11.0, kDt_s, Moved(X_WT, {0.1, 0, 0}), {}).f.norm(), 150.0, 1e-9)
      << "a hand's utmost";
}

// The tool's mass M and the hand's mass m on the spring k oscillate at sqrt(k / (M + m)) / 2 pi: at 1.30 Hz
// in the loose hand, at 5.81 Hz in the firm hand.
TEST(GripStep, ToolRingsAtTheFirmHandsFrequency) {
  for (const bool firm : {false, true}) {
    OperatorHandParams params{.stiffness_N_per_m = 300.0, .damping_Ns_per_m = 2.0, .grip_time_s = 5e-4};
    if (firm)
      params.incidents = IncidentsOf(
          {GripStep{.begin_s = 0.0, .spring = {.stiffness_N_per_m = 6000.0, .damping_Ns_per_m = 2.0}}});
    OperatorHand hand(params, Hold());
    hand.Reset();
    FreeTool tool{.damping_Ns_per_m = 0.0, .v = {0.05, 0, 0}};
    std::vector<double> crossings_s;  // times [s] at which the tool crosses zero upward
    double x_before = -1.0;
    for (int k = 1; crossings_s.size() < 6 && k < 20000; ++k) {
      tool.Step(hand, k * kDt_s, Vector3::Zero());
      if (x_before <= 0.0 && tool.x.x() > 0.0)
        crossings_s.push_back((k - tool.x.x() / (tool.x.x() - x_before)) * kDt_s);
      x_before = tool.x.x();
    }
    ASSERT_EQ(crossings_s.size(), 6u);
    const double hz =
        4.0 / (crossings_s[5] - crossings_s[1]);  // leaves out the first crossing, which depends on the start
    const double expected_hz = std::sqrt((firm ? 6000.0 : 300.0) / (3.0 + 1.5)) / (2.0 * std::numbers::pi);
    // tolerance: the mass lags by the filter time tau and a period T, which changes a third of the inertia by
    // (w (tau + T))^2 = 0.3 %
    EXPECT_NEAR(hz / expected_hz, 1.0, 3e-3);
  }
}

// Two loads: one is below the hand's max_force_N, the other exceeds it. The clamp has no such limit.
TEST(RigidClamp, DeflectsByForceOverStiffnessWithoutAForceLimit) {
  for (const double load_N : {80.0, 400.0}) {
    const Vector3 load = load_N * Vector3(2.0, -1.0, 2.0) / 3.0;
    OperatorHand hand({.max_force_N = 150.0, .incidents = IncidentsOf({RigidClamp{.begin_s = 0.5}})},
                      Hold(10.0));
    hand.Reset();
    FreeTool tool;
    Vector3 x_closed = Vector3::Zero();
    for (int k = 1; k <= 3000; ++k) {
      tool.Step(hand, k * kDt_s, k < 500 ? Vector3::Zero() : load);
      if (k == 499) x_closed = tool.x;
      if (k > 499) {  // after a step of the load, the deflection is at most twice the static one
        ASSERT_LE((tool.x - x_closed).norm(), 2.0 * load_N / 50000.0) << k;
      }
    }
    EXPECT_LT((tool.x - x_closed - load / 50000.0).norm(), 1e-3 * load_N / 50000.0);
    EXPECT_LT((tool.f_hand + load).norm(), 1e-3 * load_N);
  }
}

// The clamp must close without preload at the tool's present place, not at the script's target. When it
// opens, the hand must take over without a jolt.
TEST(RigidClamp, ClosesWhereTheToolIsAndHandsOverSmoothly) {
  const Vector3 load(30.0, 0, -20.0);
  OperatorHand hand({.incidents = IncidentsOf({RigidClamp{.begin_s = 0.5, .end_s = 1.5, .return_s = 0.4}})},
                    Hold());
  hand.Reset();
  FreeTool tool{.x = load / 2000.0};
  Vector3 f_before = Vector3::Zero();
  for (int k = 1; k <= 6000; ++k) {
    tool.Step(hand, k * kDt_s, load);
    if (k == 500) {
      EXPECT_LT(tool.f_hand.norm(), 1e-9) << "a preload";
    }
    if (k >= 1500 && k < 1900) {
      ASSERT_LT((tool.f_hand - f_before).norm(), 0.5) << k;  // small compared with the 36 N of the load
    }
    f_before = tool.f_hand;
  }
  EXPECT_LT((tool.x - load / 2000.0).norm(), 1e-6) << "back at the hand's own balance";
}

// The clamp's rotational spring has 500 Nm/rad by default. The clamp must not tremble, although the hand
// does.
TEST(RigidClamp, HoldsTheRotationWithItsSpringAndDoesNotTremble) {
  OperatorHand hand({.tremor_N = 5.0, .incidents = IncidentsOf({RigidClamp{.begin_s = 0.0}})}, Hold());
  hand.Reset();
  Pose X_WT = Hold().Sample(0.0).X_WT;
  EXPECT_EQ(hand.Step(0.0, kDt_s, X_WT, {}).f, Vector3::Zero());
  const Vector3 turn(0.01, -0.02, 0.015), p_T_head = HeadCenter(X_WT) - X_WT.translation();
  X_WT.linear() = ExpRotation(turn) * X_WT.linear();
  X_WT.translation() += p_T_head - ExpRotation(turn) * p_T_head;  // rotates about the head's centre
  const Wrench F = hand.Step(0.7, kDt_s, X_WT, {});
  EXPECT_LT(F.f.norm(), 1e-9);
  EXPECT_LT((F.t + 500.0 * turn).norm(), 1e-9);
}

// A startled release: a jerk from 0.5 to 0.55 s, an open hand from 0.58 s, the hand away until 0.83 s, and a
// full grasp at 1.03 s.
const StartledRelease kStartled{.begin_s = 0.5,
                                .jerk_N = 40.0,
                                .jerk_s = 0.05,
                                .jerk_C = Vector3(0.6, 0.0, -0.8),
                                .release_s = 0.03,
                                .away_s = 0.25,
                                .return_s = 0.2};

TEST(StartledRelease, JerksWithTheGivenImpulseThenOpensInTime) {
  const OperatorHandParams plain{.max_force_N = 500.0, .tremor_N = 1.0};
  OperatorHandParams startled = plain;
  startled.incidents = IncidentsOf({kStartled});
  OperatorHand hand(plain, Hold(60.0)), jumpy(startled, Hold(60.0));
  hand.Reset();
  jumpy.Reset();
  const Pose X_WT = Moved(Hold().Sample(0.0).X_WT, {0.01, 0.02, -0.01});
  Vector3 impulse_Ns = Vector3::Zero(), f_before = Vector3::Zero();
  for (int k = 1; k <= 1500; ++k) {
    const double t = k * kDt_s;
    const Wrench a = hand.Step(t, kDt_s, X_WT, {}), b = jumpy.Step(t, kDt_s, X_WT, {});
    if (k < 500 || k >= 1030) {  // at these times the hand must be as without an incident
      ASSERT_EQ(a.f, b.f) << t;
    }
    if (k >= 500 && k < 550) impulse_Ns += kDt_s * (b.f - a.f);
    if (k >= 550 && k < 580) {
      ASSERT_LE(b.f.norm(), a.f.norm() + 1e-12) << t;
    }
    if (k >= 580 && k < 830) {
      ASSERT_EQ(b.f, Vector3::Zero()) << t;
      ASSERT_EQ(b.t, Vector3::Zero()) << t;
    }
    // The force changes fastest while the hand opens: about 52 N (49 N and the tremor) in 30 ms along a
    // quintic, whose largest slope is 1.875 times the mean slope.
    if (k > 1) {
      ASSERT_LT((b.f - f_before).norm(), 1.9 * 52.0 / 30.0) << t;
    }
    f_before = b.f;
  }
  // the impulse is exact, because the samples of sin^2 cover its whole period
  const Vector3 expected_Ns = TiltedCup().linear() * Vector3(0.6, 0.0, -0.8) * (40.0 * 0.05 / 2.0);
  EXPECT_LT((impulse_Ns - expected_Ns).norm(), 1e-9);
}

// After a release without an end, the tool must move like a free body: in each tick its speed v is divided by
// 1 + T D / M.
TEST(StartledRelease, ToolIsFreeAfterwards) {
  StartledRelease never = kStartled;
  never.away_s = std::numeric_limits<double>::infinity();
  OperatorHand hand({.tremor_N = 2.0, .incidents = IncidentsOf({never})}, Hold());
  hand.Reset();
  FreeTool tool{.x = {0.01, 0, 0}};
  for (int k = 1; k < 580; ++k) tool.Step(hand, k * kDt_s, Vector3::Zero());
  ASSERT_GT(tool.v.norm(), 0.01);  // the jerk has set the tool in motion
  for (int k = 580; k < 1500; ++k) {
    const Vector3 v = tool.v / (1.0 + kDt_s * 20.0 / 3.0);
    tool.Step(hand, k * kDt_s, Vector3::Zero());
    ASSERT_LT((tool.v - v).norm(), 1e-15);
  }
  EXPECT_EQ(hand.Step(3600.0, kDt_s, Moved(Hold().Sample(0.0).X_WT, {0.3, 0, 0}), {}).f, Vector3::Zero());
}

// The handle is released at rest, grasped again while it moves, and then braked, repeatedly. The hand's mass
// must return no more energy than it received. If the mass followed the handle while the hand is away, it
// would return more.
TEST(StartledRelease, MassStaysPassive) {
  std::mt19937 random(5);
  std::normal_distribution<double> gauss;
  HandIncidents incidents;
  for (std::size_t i = 0; i < HandIncidents::kMax; ++i)
    incidents.list[incidents.count++] = StartledRelease{.begin_s = 0.2 * static_cast<double>(i),
                                                        .jerk_s = 0.0,
                                                        .release_s = 0.02,
                                                        .away_s = 0.03,
                                                        .return_s = 0.05};
  for (const double tau : {1e-4, 5e-3, 0.1}) {
    OperatorHand hand({.stiffness_N_per_m = 0,
                       .damping_Ns_per_m = 0,
                       .stiffness_Nm_per_rad = 0,
                       .damping_Nms_per_rad = 0,
                       .grip_time_s = tau,
                       .max_force_N = 1e9,
                       .max_torque_Nm = 1e9,
                       .incidents = incidents},
                      Hold(1e9));
    hand.Reset();
    const Pose X_WT = Hold().Sample(0.0).X_WT;
    double absorbed_J = 0.0;
    for (int k = 0; k < 1600; ++k) {
      const int tick = k % 200;
      const bool fast = tick >= 25 && tick < 120;
      const Vector3 v =
          Vector3(fast ? 0.5 : 0.0, 0, 0) + 0.01 * Vector3(gauss(random), gauss(random), gauss(random));
      absorbed_J -= hand.Step(k * kDt_s, kDt_s, X_WT, {.v = v}).f.dot(v) * kDt_s;
      ASSERT_GE(absorbed_J, -1e-12) << k;
    }
  }
}

// While the target rests, the tool is shaken. It may gain from the hand only two energies: the energy that
// spring and mass held when the incident began, and the energy of the jerk. The work is the sum of f v T with
// T = 0.1 ms. Its error is half a tick of the power at each end, 1 mJ at 20 W.
TEST(HandIncidents, AddNoEnergyExceptTheJerks) {
  const double T = 1e-4, begin_s = 0.213, k_own = 1000.0, b = 20.0, mass_kg = 1.0;
  const HandSpring stiff{.stiffness_N_per_m = 6000.0, .damping_Ns_per_m = b};
  StartledRelease release = kStartled;
  release.begin_s = begin_s;
  release.away_s = std::numeric_limits<double>::infinity();
  for (const HandIncident& incident : {HandIncident(GripStep{.begin_s = begin_s, .spring = stiff}),
                                       HandIncident(RigidClamp{.begin_s = begin_s}), HandIncident(release)}) {
    const HandIncidents incidents = IncidentsOf({incident});
    OperatorHand hand({.stiffness_N_per_m = k_own,
                       .damping_Ns_per_m = b,
                       .mass_kg = mass_kg,
                       .max_force_N = 1e9,
                       .max_torque_Nm = 1e9,
                       .incidents = incidents},
                      Hold());
    hand.Reset();
    const Pose X_WT = Hold().Sample(0.0).X_WT;
    double held_J = 0.0, given_J = 0.0, jerked_J = 0.0;
    int ticks = 0;
    for (int k = 1; k <= 20000; ++k) {
      const double t = k * T;
      const Vector3 v = ShakenSpeed(t);
      const Vector3 f = hand.Step(t, T, Moved(X_WT, Shaken(t)), {.v = v}).f;
      if (t < begin_s) continue;
      if (ticks++ == 0) {
        // the shaken tool stays below 0.2 m/s and 8 m/s^2
        held_J = 0.5 * mass_kg * 0.2 * 0.2;
        if (std::holds_alternative<GripStep>(
                incident))  // the spring's force balances f and the forces of damper and mass
          held_J += std::pow(f.norm() + b * v.norm() + mass_kg * 8.0, 2) / (2.0 * 6000.0);
        if (std::holds_alternative<StartledRelease>(incident))
          held_J += 0.5 * k_own * Shaken(t).squaredNorm();
      }
      const Vector3 jerk = TiltedCup().linear() * MomentOf(incidents, t).jerk_C_N;
      jerked_J += T * std::max(0.0, jerk.dot(v));
      given_J += T * f.dot(v);
      ASSERT_LE(given_J, held_J + jerked_J + 1e-3) << incident.index() << " at " << t;
    }
    EXPECT_GT(ticks, 17000);
  }
}

// During a grip step and a startled release, the hand's bounds must hold for random motion. Outside both, the
// script's force limit must hold as well.
TEST(HandIncidents, StayWithinTheHandsForceBounds) {
  std::mt19937 random(99);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const auto vector = [&](double s) { return Vector3(s * Vector3(u(random), u(random), u(random))); };
  const HandScript script = Hold(30.0, -0.04);
  OperatorHand hand(
      {.tremor_N = 3.0,
       .incidents = IncidentsOf({GripStep{.begin_s = 0.1, .end_s = 0.3, .return_s = 0.1}, kStartled})},
      script);
  hand.Reset();
  const Vector3 n = TiltedCup().linear().col(2);
  for (int k = 1; k <= 4000; ++k) {
    const double t = k * 5e-4, scale = std::pow(10.0, 3.0 * u(random) - 2.0);
    Pose X_WT = Moved(script.Sample(t).X_WT, vector(scale));
    X_WT.linear() = ExpRotation(vector(scale)) * X_WT.linear();
    const Wrench F = hand.Step(t, 5e-4, X_WT, {.v = vector(scale), .w = vector(10 * scale)});
    ASSERT_LE(F.f.norm(), 150.0 + 1e-9);
    ASSERT_LE(F.t.norm(), 10.0 + 1e-9);
    if (t < 0.1 || (t > 0.4 && t < 0.5) || t > 1.03) {
      ASSERT_LE(std::abs(F.f.dot(n)), 30.0 + 1e-9) << t;
    }
  }
}

// A trembling operator with four incidents, among them every kind.
OperatorHandParams Eventful() {
  return {.tremor_N = 1.0,
          .tremor_seed = 4,
          .incidents = IncidentsOf({GripStep{.begin_s = 0.1, .end_s = 0.2, .return_s = 0.1}, kStartled,
                                    RigidClamp{.begin_s = 1.1, .end_s = 1.3, .return_s = 0.1},
                                    GripStep{.begin_s = 1.5}})};
}

// The same input must give the same bits, also after Reset(). An incident that has not yet begun must change
// no bit.
TEST(HandIncidents, GiveTheSameBitsForTheSameInput) {
  const auto run = [](OperatorHand& hand) {
    hand.Reset();
    std::vector<Vector3> wrenches;
    FreeTool tool;
    for (int k = 1; k <= 2000; ++k) {
      tool.Step(hand, k * kDt_s, Vector3(10.0 * std::sin(0.01 * k), 5.0, 0.0));
      wrenches.push_back(tool.f_hand);
      wrenches.push_back(tool.x);
    }
    return wrenches;
  };
  OperatorHand a(Eventful(), Hold(40.0)), b(Eventful(), Hold(40.0));
  const std::vector<Vector3> first = run(a);
  EXPECT_EQ(first, run(b));
  EXPECT_EQ(first, run(a));
  OperatorHandParams none = Eventful(), later = Eventful();
  none.incidents = {};
  later.incidents = IncidentsOf({RigidClamp{.begin_s = 2.5}});
  OperatorHand c(none, Hold(40.0)), d(later, Hold(40.0));
  EXPECT_EQ(run(c), run(d));
}

TEST(HandIncidents, DoNotAllocate) {
  OperatorHand hand(Eventful(), Hold());
  const Pose X_WT = Hold().Sample(0.0).X_WT;
  rt::CheckedNoAllocScope no_alloc;
  hand.Reset();
  for (int k = 0; k < 2000; ++k) (void)hand.Step(k * kDt_s, kDt_s, X_WT, {});
}

TEST(HandIncidents, OutOfRangeOrOverlappingAreRefused) {
  const auto error_of = [](std::initializer_list<HandIncident> list) -> std::string {
    try {
      OperatorHand hand({.incidents = IncidentsOf(list)}, Hold());
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  const double nan = std::nan("");
  EXPECT_EQ(error_of({GripStep{.begin_s = 1, .end_s = 2, .return_s = 0.5}, RigidClamp{.begin_s = 2.5}}),
            "accepted");
  EXPECT_EQ(error_of({GripStep{.begin_s = 1, .end_s = 2, .return_s = 0.5}, RigidClamp{.begin_s = 2.4}}),
            "operator's incident 2: begin_s: found 2.4, accepted >= 2.5");
  EXPECT_NE(error_of({GripStep{.begin_s = 1}, kStartled}), "accepted") << "never ends";
  EXPECT_NE(error_of({GripStep{.begin_s = 1, .end_s = 1}}), "accepted");
  EXPECT_NE(error_of({GripStep{.begin_s = -1}}), "accepted");
  EXPECT_NE(error_of({GripStep{.begin_s = nan}}), "accepted");
  EXPECT_NE(error_of({GripStep{.return_s = 0}}), "accepted");
  EXPECT_NE(error_of({RigidClamp{.spring = {.stiffness_N_per_m = -1}}}), "accepted");
  EXPECT_NE(error_of({StartledRelease{.jerk_C = Vector3(1, 1, 0)}}), "accepted");
  EXPECT_NE(error_of({StartledRelease{.release_s = 0}}), "accepted");
  EXPECT_NE(error_of({StartledRelease{.away_s = nan}}), "accepted");
  OperatorHandParams too_many;
  too_many.incidents.count = HandIncidents::kMax + 1;
  EXPECT_THROW(OperatorHand(too_many, Hold()), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::hil
