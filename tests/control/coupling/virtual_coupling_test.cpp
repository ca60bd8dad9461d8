#include "control/coupling/virtual_coupling.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "control/laws/admittance_law.h"
#include "safety/limits.h"
#include "tests/base/checked_no_alloc_scope.h"

// Tests the virtual coupling, which computes the wrench with which the planes of a contact model push the
// tool.

namespace osteon::control {
namespace {

using rt::kMillisecond;
using simulation::Contact;
using simulation::ContactModel;

constexpr double kK = 20e3;  // [N/m]
constexpr double kDt_s = 0.001;

// A model with one plane through the origin of W, which the tool's apex touches.
// @param advance_m_per_s  speed at which the plane recedes during cutting
ContactModel Plane(const Vector3& n_W, double advance_m_per_s = 0.0) {
  ContactModel model;
  model.contact_count = 1;
  model.contacts[0].n_W = n_W;
  model.contacts[0].stiffness_N_per_m = kK;
  model.contacts[0].advance_m_per_s = advance_m_per_s;
  model.frame = 1;
  model.F_T_W.f = Vector3(100.0 * n_W);
  return model;
}

Pose At(const Vector3& p_WT) {
  Pose X_WT = Pose::Identity();
  X_WT.translation() = p_WT;
  return X_WT;
}

// The coupling, already faded in. Each tick may have a model of another age.
struct Bench {
  CouplingParams params;
  CouplingState state;
  rt::Nanoseconds now{rt::kSecond};

  Bench() { state.fade = 1.0; }

  CouplingOutput Tick(ContactModel model, const Pose& X_WT, const Twist& V_WT = {}, bool spindle_on = false,
                      double age_s = 0.0) {
    now += kMillisecond;
    model.pose_stamp = now - std::llround(age_s * 1e9);
    return EvaluateCoupling(
        params, {.model = model, .X_WT = X_WT, .V_WT = V_WT, .now = now, .spindle_turns = spindle_on}, state);
  }
};

TEST(VirtualCoupling, APlaneIsALinearSpringOnOneSide) {
  Bench bench;
  const ContactModel model = Plane({0.0, 0.0, 1.0});
  const CouplingOutput in = bench.Tick(model, At({0.01, 0.0, -2e-3}));
  EXPECT_TRUE(in.F_T_W.f.isApprox(Vector3(0.0, 0.0, 40.0), 1e-12));
  EXPECT_TRUE(in.F_T_W.t.isZero(1e-12)) << "the contact is at T's origin";
  EXPECT_EQ(in.active_count, 1);
  EXPECT_NEAR(in.normal_force_N[0], 40.0, 1e-10);
  EXPECT_TRUE(in.displacement_W.isApprox(Vector3(0.0, 0.0, 2e-3), 1e-12));
  const CouplingOutput out = bench.Tick(model, At({0.01, 0.0, 1e-3}));
  EXPECT_TRUE(out.F_T_W.f.isZero(0.0));
  EXPECT_EQ(out.active_count, 0);
}

// Oracle: r × f, computed in the test for a contact at 25 mm from the apex of a rotated tool.
TEST(VirtualCoupling, TorqueIsTheForcesLeverAboutTheApex) {
  Bench bench;
  ContactModel model = Plane({1.0, 0.0, 0.0});
  model.contacts[0].p_TP_m = Vector3(-0.025, 0.0, -0.025);
  model.contacts[0].p_W_m = Vector3(0.1, 0.0, 0.0);
  Pose X_WT = At({0.124, 0.0, 0.0});
  const CouplingOutput out = bench.Tick(model, X_WT);  // the contact is at x = 0.099, which is 1 mm inside
  EXPECT_TRUE(out.F_T_W.f.isApprox(Vector3(20.0, 0.0, 0.0), 1e-10));
  EXPECT_TRUE(out.F_T_W.t.isApprox(Vector3(0.0, -0.025 * 20.0, 0.0), 1e-10));
}

// Two faces meet at 90°, and the proxy lies on their common edge.
TEST(VirtualCoupling, ACornerGivesTheVectorSumOfBothFaces) {
  Bench bench;
  ContactModel model = Plane({1.0, 0.0, 0.0});
  model.contact_count = 2;
  model.contacts[1] = model.contacts[0];
  model.contacts[1].n_W = Vector3(0.0, 0.0, 1.0);
  const CouplingOutput out = bench.Tick(model, At({-1e-3, 0.0, -2e-3}));
  EXPECT_TRUE(out.F_T_W.f.isApprox(Vector3(20.0, 0.0, 40.0), 1e-10));
  EXPECT_EQ(out.active_count, 2);
  model.contacts[1].n_W = Vector3(1.0, 0.0, 0.0);
  EXPECT_NEAR(bench.Tick(model, At({-1e-3, 0.0, 0.0})).F_T_W.f.x(), 20.0, 1e-8)
      << "the same face twice is one spring, not two";
}

TEST(VirtualCoupling, DampingDissipatesWithinItsShareAndNeverPulls) {
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 20'000; ++i) {
    Bench bench;
    ContactModel model = Plane(Vector3(normal(random), normal(random), normal(random)).normalized());
    model.contacts[0].p_TP_m = Vector3(0.02 * Vector3(normal(random), normal(random), normal(random)));
    Pose X_WT = At(0.002 * Vector3(normal(random), normal(random), normal(random)));
    X_WT.linear() = ExpRotation({normal(random), normal(random), normal(random)});
    const Twist V{.v = 0.1 * Vector3(normal(random), normal(random), normal(random)),
                  .w = Vector3(normal(random), normal(random), normal(random))};
    const Wrench rest = bench.Tick(model, X_WT).F_T_W;
    const Wrench moving = bench.Tick(model, X_WT, V).F_T_W;
    const double damping_W = (moving.f - rest.f).dot(V.v) + (moving.t - rest.t).dot(V.w);
    ASSERT_LE(damping_W, 1e-9) << "takes power";
    ASSERT_GE(Vector3(model.contacts[0].n_W).dot(moving.f), 0.0) << "never pulls";
    ASSERT_LE(moving.f.norm(), 1.25 * rest.f.norm() * (1.0 + 1e-12)) << "no step at a fresh contact";
    ASSERT_LT(moving.f.cross(rest.f).norm(), 1e-9 * (1.0 + rest.f.squaredNorm())) << "along the resultant";
  }
}

// The tool hits a static plane without a hand, at a random speed and angle. It must leave the plane more
// slowly than it came.
TEST(VirtualCoupling, WithAdmittanceAStaticWallReturnsNoMoreEnergyThanItGot) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> speed(0.005, 0.25), angle(-1.2, 1.2);
  for (const double damping : {0.0, 100.0}) {
    for (int run = 0; run < 200; ++run) {
      Bench bench;
      bench.params.damping_Ns_per_m = damping;
      const ContactModel model = Plane({0.0, 0.0, 1.0});
      const double v0 = speed(random), a = angle(random);
      AdmittanceState state{
          .X_WT = At({0.0, 0.0, 1e-4}),
          .V_WT = {.v = v0 * Vector3(std::sin(a), 0.0, -std::cos(a)), .w = Vector3::Zero()}};
      bool touched = false, left = false;
      for (int i = 0; i < 3000 && !left; ++i) {
        const CouplingOutput out = bench.Tick(model, state.X_WT, state.V_WT);
        ASSERT_TRUE(StepAdmittance({}, out.F_T_W, kDt_s, state));
        touched = touched || out.active_count > 0;
        left = touched && state.X_WT.translation().z() > 0.0;
        if (left) {
          ASSERT_LT(state.V_WT.v.norm(), v0) << "run " << run;
        }
      }
      ASSERT_TRUE(touched);
    }
  }
}

// First contact at the speed limit, with a hand that pushes. The trip on the wrench's rate must not act.
TEST(VirtualCoupling, AFirstContactAtFullSpeedDoesNotTripTheRate) {
  Bench bench;
  safety::WrenchRateTrip trip(kK, 0.25);
  AdmittanceState state{.X_WT = At({0.0, 0.0, 1e-3}), .V_WT = {.v = {0.0, 0.0, -0.25}, .w = Vector3::Zero()}};
  for (int i = 0; i < 500; ++i) {
    const CouplingOutput out = bench.Tick(Plane({0.0, 0.0, 1.0}), state.X_WT, state.V_WT);
    ASSERT_FALSE(trip.Check(out.F_T_W.f, kDt_s)) << "tick " << i;
    ASSERT_TRUE(
        StepAdmittance({}, {.f = out.F_T_W.f - Vector3(0, 0, 120.0), .t = out.F_T_W.t}, kDt_s, state));
    state.V_WT = safety::LimitTwist(state.V_WT, {}).V;
  }
}

TEST(VirtualCoupling, FadesOutWithTheModelsAgeAtOnceAndFadesInSlowly) {
  Bench bench;
  const ContactModel model = Plane({0.0, 0.0, 1.0});
  const Pose X_WT = At({0.0, 0.0, -5e-3});
  EXPECT_NEAR(bench.Tick(model, X_WT, {}, false, 0.020).F_T_W.f.z(), 100.0, 1e-9);
  EXPECT_NEAR(bench.Tick(model, X_WT, {}, false, 0.050).F_T_W.f.z(), 25.0, 1e-4);
  EXPECT_EQ(bench.Tick(model, X_WT, {}, false, 0.060).F_T_W.f.z(), 0.0);
  EXPECT_EQ(bench.Tick(model, X_WT, {}, false, 10.0).F_T_W.f.z(), 0.0);
  double before_N = 0.0;
  for (int i = 1; i <= 100; ++i) {
    const double f_N = bench.Tick(model, X_WT).F_T_W.f.z();
    ASSERT_NEAR(f_N - before_N, 1.0, 1e-6) << "0 to 1 in 100 ms";
    before_N = f_N;
  }
  EXPECT_NEAR(bench.Tick(model, X_WT).F_T_W.f.z(), 100.0, 1e-9);
}

TEST(VirtualCoupling, APlaneRecedesOnlyUnderForceWithSpindleOnAndFreshModel) {
  const double advance_m_per_s = 2e-3;  // 2 µm per tick
  const auto force_after_10_ms = [&](bool spindle_on, double depth_m, double extra_age_s) {
    Bench bench;
    ContactModel model = Plane({0.0, 0.0, 1.0}, advance_m_per_s);
    model.pose_stamp = bench.now;
    CouplingOutput out;
    for (int i = 0; i <= 10; ++i) {
      out = EvaluateCoupling(bench.params,
                             {.model = model,
                              .X_WT = At({0.0, 0.0, -depth_m}),
                              .now = bench.now + static_cast<rt::Nanoseconds>(extra_age_s * 1e9),
                              .spindle_turns = spindle_on},
                             bench.state);
      bench.now += kMillisecond;
    }
    return out.F_T_W.f.z() / out.fade;
  };
  EXPECT_NEAR(force_after_10_ms(true, 1e-3, 0.0), 20.0 - kK * advance_m_per_s * 0.010, 1e-9);
  EXPECT_NEAR(force_after_10_ms(false, 1e-3, 0.0), 20.0, 1e-9) << "spindle still";
  EXPECT_NEAR(force_after_10_ms(true, 1e-3, 0.025), 20.0, 1e-9) << "stale";
  EXPECT_NEAR(force_after_10_ms(true, 5e-6, 0.0), 0.0, 1e-9) << "never further than the tool";
}

TEST(VirtualCoupling, WithoutForceAPlaneDoesNotRecede) {
  Bench bench;
  ContactModel model = Plane({0.0, 0.0, 1.0}, 0.01);
  model.pose_stamp = bench.now;
  for (int i = 0; i < 10; ++i) {  // the tool hovers above the plane
    bench.now += kMillisecond;
    const CouplingOutput hovering = EvaluateCoupling(
        bench.params, {.model = model, .X_WT = At({0.0, 0.0, 1e-3}), .now = bench.now, .spindle_turns = true},
        bench.state);
    ASSERT_EQ(hovering.active_count, 0);
  }
  bench.now += kMillisecond;
  const CouplingOutput out = EvaluateCoupling(
      bench.params, {.model = model, .X_WT = At({0.0, 0.0, -1e-3}), .now = bench.now, .spindle_turns = true},
      bench.state);
  EXPECT_NEAR(out.F_T_W.f.z(), 20.0, 1e-9);
}

// Bone recedes at 1 mm/s, and the tool follows at a constant depth, so the exact force is constant. Every 4
// ms the simulation reports the bone as it was 3 ms ago.
TEST(VirtualCoupling, NewFramesOfRecedingBoneCauseNoForceStep) {
  Bench bench;
  const double advance_m_per_s = 1e-3, depth_m = 4e-3;
  const rt::Nanoseconds start = bench.now;
  const auto surface_m = [&](rt::Nanoseconds t) { return -advance_m_per_s * rt::ToSeconds(t - start); };
  ContactModel model;
  double low_N = 1e9, high_N = 0.0;
  for (int i = 0; i < 400; ++i) {
    bench.now += kMillisecond;
    if (i % 4 == 0) {
      const rt::Nanoseconds stamp = bench.now - 3 * kMillisecond;
      model = Plane({0.0, 0.0, 1.0}, advance_m_per_s);
      model.contacts[0].p_W_m = Vector3(0.0, 0.0, surface_m(stamp));
      model.frame = static_cast<std::uint64_t>(i / 4 + 1);
      model.pose_stamp = stamp;
    }
    const Pose X_WT = At({0.0, 0.0, surface_m(bench.now) - depth_m});
    const CouplingOutput out = EvaluateCoupling(
        bench.params, {.model = model, .X_WT = X_WT, .now = bench.now, .spindle_turns = true}, bench.state);
    if (i < 70) continue;  // until the recorded history of cutting covers the delay
    low_N = std::min(low_N, out.F_T_W.f.z());
    high_N = std::max(high_N, out.F_T_W.f.z());
  }
  EXPECT_NEAR(low_N, kK * depth_m, 1e-6);
  EXPECT_NEAR(high_N, kK * depth_m, 1e-6) << "without the recession in between: 0.14 N of saw-tooth";
}

// The bone recedes less than predicted. The new frame's plane lies 0.35 mm higher than the last one, in front
// of the proxy. The coupling must hold the plane back and release it within return_s.
TEST(VirtualCoupling, ANewPlaneBeforeTheProxyIsReleasedOverReturnTime) {
  Bench bench;
  ContactModel model = Plane({0.0, 0.0, 1.0});
  const Pose X_WT = At({0.0, 0.0, -1e-3});
  EXPECT_NEAR(bench.Tick(model, X_WT).F_T_W.f.z(), 20.0, 1e-9);
  const double jump_m = 0.35e-3;
  const int ticks = 8;  // return_s in ticks
  for (int i = 1; i <= 3 * ticks; ++i) {
    if (i % 4 == 1) {  // every 4 ms a new frame of the unchanged bone
      model.frame += 1;
      model.contacts[0].p_W_m = Vector3(0.0, 0.0, jump_m);
    }
    const CouplingOutput out = bench.Tick(model, X_WT, {}, false, 1e-3 * ((i + 3) % 4));
    const double back = std::min(1.0, static_cast<double>(i) / ticks);
    EXPECT_NEAR(out.F_T_W.f.z(), 20.0 + kK * jump_m * back, 1e-6) << "tick " << i << ": 7 N at once without";
    EXPECT_EQ(out.new_planes, i % 4 == 1 || i <= ticks) << "the tank pays for it";
  }
}

// While the tool moves, a new frame has a plane where the last frame had free air. Only the force that the
// plane would have had at the last tick's pose may be held back. The force due to this tick's own motion (0.3
// mm) must act at once.
TEST(VirtualCoupling, ANewPlaneIsNotHeldBackForThisTicksOwnMotion) {
  Bench bench;
  ContactModel free_air = Plane({0.0, 0.0, 1.0});
  free_air.contact_count = 0;
  Pose before = At({0.0, 0.0, 0.0}), after = At({0.0, 0.0, -0.2e-3});
  // a rotation in the same tick moves the touching point by another 0.1 mm into the bone, with a lever of 0.1
  // m
  after.linear() = Eigen::AngleAxisd(1e-3, Vector3::UnitY()).toRotationMatrix();
  bench.Tick(free_air, before);
  ContactModel model = Plane({0.0, 0.0, 1.0});
  model.frame = free_air.frame + 1;
  model.contacts[0].p_TP_m = Vector3(0.1, 0.0, 0.0);
  EXPECT_NEAR(bench.Tick(model, after).F_T_W.f.z(), kK * 0.3e-3, 1e-6);
}

TEST(VirtualCoupling, APlaneThatMovesAwayLowersTheForceAtOnce) {
  Bench bench;
  ContactModel model = Plane({0.0, 0.0, 1.0});
  const Pose X_WT = At({0.0, 0.0, -1e-3});
  bench.Tick(model, X_WT);
  model.frame += 1;
  model.contacts[0].p_W_m = Vector3(0.0, 0.0, -0.4e-3);
  EXPECT_NEAR(bench.Tick(model, X_WT).F_T_W.f.z(), 12.0, 1e-9);
}

// The tool is between two walls whose distance is smaller than the tool, so no proxy satisfies both planes.
// New frames of the same walls must not change the force.
TEST(VirtualCoupling, BetweenWallsTooCloseNewFramesDoNotChangeTheForce) {
  Bench bench;
  ContactModel model = Plane({1.0, 0.0, 0.0});
  model.contact_count = 2;
  model.contacts[1] = model.contacts[0];
  model.contacts[0].p_W_m = Vector3(1e-3, 0.0, 0.0);
  model.contacts[1].p_W_m = Vector3(-1e-3, 0.0, 0.0);
  model.contacts[1].n_W = Vector3(-1.0, 0.0, 0.0);
  const Pose X_WT = At({0.2e-3, 0.0, 0.0});
  const double first_N = bench.Tick(model, X_WT).F_T_W.f.x();
  EXPECT_LT(first_N, -1.0) << "toward the middle";
  for (int i = 0; i < 20; ++i) {
    if (i % 4 == 0) model.frame += 1;
    EXPECT_NEAR(bench.Tick(model, X_WT, {}, false, 1e-3 * (i % 4)).F_T_W.f.x(), first_N, 1e-6);
  }
}

TEST(VirtualCoupling, SpindleTorqueActsOnTheToolInProportionToTheForce) {
  Bench bench;
  ContactModel model = Plane({0.0, 0.0, 1.0});
  model.spindle_torque_Nm = 1.2;  // at the frame's force of 100 N
  const CouplingOutput half = bench.Tick(model, At({0.0, 0.0, -2.5e-3}), {}, true);
  EXPECT_TRUE(half.F_T_W.t.isApprox(Vector3(0.0, 0.0, -0.6), 1e-9)) << "50 N";
  EXPECT_TRUE(bench.Tick(model, At({0.0, 0.0, -2.5e-3}), {}, false).F_T_W.t.isZero(0.0)) << "spindle still";
  EXPECT_TRUE(bench.Tick(model, At({0.0, 0.0, 1e-3}), {}, true).F_T_W.t.isZero(0.0)) << "no contact";
}

TEST(VirtualCoupling, AContactStifferThanAllowedHasTheMaximumStiffness) {
  Bench bench;
  ContactModel model = Plane({0.0, 0.0, 1.0});
  model.contacts[0].stiffness_N_per_m = 1e6;
  EXPECT_NEAR(bench.Tick(model, At({0.0, 0.0, -1e-3})).F_T_W.f.z(), 20.0, 1e-9);
}

TEST(VirtualCoupling, AModelThatIsNotCredibleRendersNothingAndReportsWhy) {
  const auto status_of = [](const auto& spoil) {
    Bench bench;
    ContactModel model = Plane({0.0, 0.0, 1.0});
    spoil(model);
    const CouplingOutput out = bench.Tick(model, At({0.0, 0.0, -1e-3}));
    EXPECT_TRUE(out.F_T_W.f.isZero(0.0) && out.F_T_W.t.isZero(0.0));
    return out.status;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(status_of([](ContactModel& m) { m.frame = 0; }), ModelStatus::kNone);
  EXPECT_EQ(status_of([](ContactModel& m) { m.contact_count = 9; }), ModelStatus::kNotCredible);
  EXPECT_EQ(status_of([](ContactModel& m) { m.contact_count = -1; }), ModelStatus::kNotCredible);
  EXPECT_EQ(status_of([&](ContactModel& m) { m.contacts[0].n_W.x = nan; }), ModelStatus::kNotCredible);
  EXPECT_EQ(status_of([&](ContactModel& m) { m.contacts[0].n_W = Vector3(0, 0, 5.0); }),
            ModelStatus::kNotCredible);
  EXPECT_EQ(status_of([&](ContactModel& m) { m.contacts[0].p_W_m.y = 1e300; }), ModelStatus::kNotCredible);
  EXPECT_EQ(status_of([&](ContactModel& m) { m.contacts[0].stiffness_N_per_m = -1; }),
            ModelStatus::kNotCredible);
  EXPECT_EQ(status_of([&](ContactModel& m) { m.contacts[0].advance_m_per_s = nan; }),
            ModelStatus::kNotCredible);
  EXPECT_EQ(status_of([&](ContactModel& m) { m.spindle_torque_Nm = nan; }), ModelStatus::kNotCredible);
  EXPECT_EQ(status_of([](ContactModel& m) { m.status = simulation::EngineStatus::kDeviceLost; }),
            ModelStatus::kDeviceLost);
}

// The bytes of the contacts are overwritten at random, so any bit pattern may occur.
TEST(VirtualCoupling, IsFiniteForModelsOfRandomBits) {
  std::mt19937_64 random(8);
  CouplingState state;
  for (int i = 0; i < 20'000; ++i) {
    ContactModel model = Plane({0.0, 0.0, 1.0});
    auto* bytes = reinterpret_cast<unsigned char*>(&model.contacts);
    for (int k = 0; k < 40; ++k)
      bytes[random() % sizeof(model.contacts)] = static_cast<unsigned char>(random());
    model.contact_count = static_cast<std::int32_t>(random() % 12) - 2;
    model.pose_stamp = static_cast<rt::Nanoseconds>(random());
    const CouplingOutput out = EvaluateCoupling({},
                                                {.model = model,
                                                 .X_WT = At({0.0, 0.0, -1e-3}),
                                                 .now = static_cast<rt::Nanoseconds>(random() >> 20),
                                                 .spindle_turns = true},
                                                state);
    ASSERT_TRUE(safety::IsFinite(out.F_T_W)) << "draw " << i;
    ASSERT_TRUE(out.fade >= 0.0 && out.fade <= 1.0);
  }
}

TEST(VirtualCoupling, RefusesParametersOutOfRange) {
  EXPECT_THROW(Validate(CouplingParams{.damping_share = 0.6}), std::invalid_argument);
  EXPECT_THROW(Validate(CouplingParams{.fresh_s = 0.06, .gone_s = 0.02}), std::invalid_argument);
  EXPECT_NO_THROW(Validate(CouplingParams{}));
}

TEST(VirtualCoupling, DoesNotAllocate) {
  Bench bench;
  const ContactModel model = Plane({0.0, 0.0, 1.0}, 1e-3);
  rt::CheckedNoAllocScope no_alloc;
  const CouplingOutput out = bench.Tick(model, At({0.0, 0.0, -1e-3}), {}, true);
  no_alloc.End();
  EXPECT_EQ(out.active_count, 1);
}

}  // namespace
}  // namespace osteon::control
