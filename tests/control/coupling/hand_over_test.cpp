#include "control/coupling/hand_over.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "control/coupling/virtual_coupling.h"
#include "control/stability/energy_tank.h"
#include "safety/limits.h"
#include "tests/base/checked_no_alloc_scope.h"

// Tests the hand-over. When the planes of a new frame appear, vanish or turn, as on curved bone, the coupling
// turns its force to the new planes over some ticks instead of at once.

namespace osteon::control {
namespace {

using simulation::ContactModel;

// Stiffness [N/m], largest tool speed and period in the shipped drilling cells. A hand-over takes return_s =
// 8 ms.
constexpr double kK = 60e3, kSpeed_m_per_s = 0.15, kDt_s = 1e-3;
constexpr int kReturnTicks = 8;

Pose At(const Vector3& p_WT) {
  Pose X_WT = Pose::Identity();
  X_WT.translation() = p_WT;
  return X_WT;
}

// Unit normal that is tilted by `tilt_rad` from z, toward the direction at angle `turn_rad` about z.
Vector3 Tilted(double tilt_rad, double turn_rad) {
  return {std::sin(tilt_rad) * std::cos(turn_rad), std::sin(tilt_rad) * std::sin(turn_rad),
          std::cos(tilt_rad)};
}

// Adds a plane of stiffness kK through p_W. The tool's point p_T touches it.
void AddPlane(ContactModel& model, const Vector3& n_W, const Vector3& p_W,
              const Vector3& p_T = Vector3::Zero()) {
  simulation::Contact& plane = model.contacts[static_cast<std::size_t>(model.contact_count++)];
  plane.n_W = n_W;
  plane.p_W_m = p_W;
  plane.p_TP_m = p_T;
  plane.stiffness_N_per_m = kK;
}

// The coupling, already faded in, and the trip on the wrench's rate.
struct Bench {
  CouplingParams params{.max_stiffness_N_per_m = kK};
  CouplingState state;
  safety::WrenchRateTrip trip{kK, kSpeed_m_per_s};
  rt::Nanoseconds now{rt::kSecond};
  ContactModel model;
  bool tripped{false};

  Bench() { state.fade = 1.0; }
  // Begins a new frame without planes.
  void NewFrame() {
    model.contact_count = 0;
    model.contacts = {};
    ++model.frame;
    model.pose_stamp = now;
  }
  CouplingOutput Tick(const Pose& X_WT, const Twist& V_WT = {}) {
    now += rt::kMillisecond;
    const CouplingOutput out = EvaluateCoupling(
        params, {.model = model, .X_WT = X_WT, .V_WT = V_WT, .now = now, .spindle_turns = true}, state);
    tripped = trip.Check(out.F_T_W.f, kDt_s);
    return out;
  }
};

// The plane under the drill leans by 11° in the next frame, as recorded on a femoral head. Without a
// hand-over, the force changed from (0.3, -1.8, 89.5) N to (-4.4, -17.0, 87.0) N within a tick; the trip acts
// from 13.5 N on.
TEST(HandOver, APlaneThatLeansInTheNextFrameTurnsTheForceEvenlyWithinReturnTime) {
  Bench bench;
  bench.NewFrame();
  AddPlane(bench.model, Vector3::UnitZ(), Vector3::Zero());
  const Pose X_WT = At({0.0, 0.0, -1.5e-3});
  bench.trip = safety::WrenchRateTrip(1e9, 1.0);
  EXPECT_NEAR(bench.Tick(X_WT).F_T_W.f.z(), 90.0, 1e-9);
  bench.trip = safety::WrenchRateTrip(kK, kSpeed_m_per_s);
  static_cast<void>(bench.trip.Check({0.0, 0.0, 90.0}, 1.0));

  const Vector3 n_W = Tilted(0.2, -1.5);
  bench.NewFrame();
  AddPlane(bench.model, n_W, Vector3::Zero());
  const double size_N = 90.0 * n_W.z();
  double before_rad = 0.0;
  for (int tick = 1; tick <= kReturnTicks; ++tick) {
    const Wrench F = bench.Tick(X_WT).F_T_W;
    EXPECT_FALSE(bench.tripped) << "tick " << tick << ": " << bench.trip.growth_N()
                                << " N; 17.6 N at once without";
    EXPECT_LE(F.f.norm(), size_N * (1.0 + 1e-12)) << "no more than the planes' own force";
    EXPECT_GE(F.f.norm(), 0.99 * size_N) << "and hardly less";
    const double turned_rad = std::acos(std::min(1.0, F.f.normalized().z()));
    EXPECT_GT(turned_rad, before_rad);
    EXPECT_LT(turned_rad - before_rad, 1.1 * 0.2 / kReturnTicks) << "evenly";
    before_rad = turned_rad;
  }
  EXPECT_TRUE(bench.Tick(X_WT).F_T_W.f.isApprox(size_N * n_W, 1e-9));
}

TEST(HandOver, AForceThatFallsIsNotDelayed) {
  Bench bench;
  bench.NewFrame();
  AddPlane(bench.model, Vector3::UnitZ(), Vector3::Zero());
  static_cast<void>(bench.Tick(At({0.0, 0.0, -1.5e-3})));
  bench.NewFrame();
  AddPlane(bench.model, Tilted(0.5, 0.3), Vector3::Zero());
  const double size_N = 90.0 * std::cos(0.5);
  EXPECT_LE(bench.Tick(At({0.0, 0.0, -1.5e-3})).F_T_W.f.norm(), size_N) << "the new planes' force, at once";
  // the tool is pulled back while the force is still being turned
  for (const double depth_m : {0.8e-3, 0.3e-3, 0.05e-3}) {
    const CouplingOutput out = bench.Tick(At({0.0, 0.0, -depth_m}));
    EXPECT_LE(out.F_T_W.f.norm(), kK * depth_m * std::cos(0.5) * (1.0 + 1e-9));
    EXPECT_FALSE(bench.tripped);
  }
  EXPECT_TRUE(bench.Tick(At({0.0, 0.0, 0.1e-3})).F_T_W.f.isZero(0.0)) << "out of the bone there is nothing";
  EXPECT_TRUE(bench.Tick(At({0.0, 0.0, -0.05e-3})).F_hand_over_T_W.f.isZero(0.0)) << "nor is anything left";
}

TEST(HandOver, ASmallTurnEndsWithinOneTick) {
  Bench bench;
  bench.NewFrame();
  AddPlane(bench.model, Vector3::UnitZ(), Vector3::Zero());
  static_cast<void>(bench.Tick(At({0.0, 0.0, -1e-3})));
  bench.NewFrame();
  AddPlane(bench.model, Tilted(0.02, 0.0), Vector3::Zero());
  const CouplingOutput out = bench.Tick(At({0.0, 0.0, -1e-3}));
  EXPECT_TRUE(out.F_T_W.f.isApprox(60.0 * std::cos(0.02) * Tilted(0.02, 0.0), 1e-9)) << "1.2 N of 1.5";
  EXPECT_EQ(out.hand_over_s, 0.0) << "the age governor counts no more age";
}

// The contact point changes together with the force's direction, so the torque must be handed over as well.
// The old direction of the force at the new point would turn the tool.
TEST(HandOver, TheTorqueIsHandedOverTogetherWithTheForce) {
  Bench bench;
  bench.NewFrame();
  const Vector3 first_T(0.0, 0.0, -0.02), second_T(0.01, 0.0, -0.015);
  AddPlane(bench.model, Vector3::UnitZ(), first_T, first_T);
  const Pose X_WT = At({0.0, 0.0, -1e-3});
  const Wrench before = bench.Tick(X_WT).F_T_W;
  EXPECT_TRUE(before.t.isApprox(first_T.cross(before.f), 1e-12) || before.t.isZero(1e-12));
  const Vector3 n_W = Tilted(0.4, 0.0);
  bench.NewFrame();
  AddPlane(bench.model, n_W, second_T, second_T);
  const Wrench F_end{.f = 60.0 * n_W.z() * n_W, .t = second_T.cross(60.0 * n_W.z() * n_W)};
  for (int tick = 1; tick <= kReturnTicks; ++tick) {
    const Wrench F = bench.Tick(X_WT).F_T_W;
    const double weight = 1.0 - static_cast<double>(tick) / kReturnTicks, scale = n_W.z();
    EXPECT_LT((F.f - (weight * scale * before.f + (1.0 - weight) * F_end.f)).norm(), 1e-6) << tick;
    EXPECT_LT((F.t - (weight * scale * before.t + (1.0 - weight) * F_end.t)).norm(), 1e-8) << tick;
  }
}

/// Random frames like those of a convex bone: 1 to 7 planes close to the proxy, with normals in a cone about
/// z. From frame to frame, planes appear, vanish and lean differently.
class ChangingPlanes {
 public:
  explicit ChangingPlanes(std::uint64_t seed) : bits_(seed) {}

  void Frame(Bench& bench, const Vector3& p_WP, double cone_rad) {
    bench.NewFrame();
    const int count = 1 + static_cast<int>(Uniform(0.0, 6.999));
    for (int i = 0; i < count; ++i) {
      const Vector3 n_W = Tilted(Uniform(0.0, cone_rad), Uniform(0.0, 6.283));
      AddPlane(bench.model, n_W, p_WP + Uniform(-20e-6, 3e-6) * n_W);
    }
  }
  double Uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(bits_); }

 private:
  std::mt19937_64 bits_;
};

// The planes change every 1 to 30 ms, while the tool is held 1.5 mm deep.
TEST(HandOver, NoChangeOfPlanesTripsTheRateOrRaisesTheForce) {
  double max_step_N = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    for (const int frame_ticks : {1, 2, 3, 5, 8, 13, 30}) {
      ChangingPlanes planes(seed);
      Bench bench;
      bench.NewFrame();
      AddPlane(bench.model, Vector3::UnitZ(), Vector3::Zero());
      const Pose X_WT = At({0.0, 0.0, -1.5e-3});
      // brings the tool into contact gradually, because the first contact is not a hand-over
      for (int i = 0; i < 60; ++i) {
        bench.model.contacts[0].p_W_m = Vector3(0.0, 0.0, -1.5e-3 + 25e-6 * i);
        ++bench.model.frame;
        static_cast<void>(bench.Tick(X_WT));
      }
      for (int tick = 0; tick < 600; ++tick) {
        if (tick % frame_ticks == 0) planes.Frame(bench, bench.state.X_WP.translation(), 0.45);
        const CouplingOutput out = bench.Tick(X_WT);
        max_step_N = std::max(max_step_N, bench.trip.growth_N());
        ASSERT_FALSE(bench.tripped) << "seed " << seed << ", frames of " << frame_ticks << " ms, tick "
                                    << tick << ": " << bench.trip.growth_N() << " N";
        ASSERT_LE(out.F_T_W.f.norm(), kK * out.displacement_W.norm() * (1.0 + 1e-9))
            << "never more than the planes'";
        for (int j = 0; j < bench.model.contact_count; ++j) {
          const auto& plane = bench.model.contacts[static_cast<std::size_t>(j)];
          if (out.normal_force_N[static_cast<std::size_t>(j)] > 0.0) {
            ASSERT_GE(Vector3(plane.n_W).dot(out.F_T_W.f), 0.0) << "never pulls";
          }
        }
      }
    }
  }
  RecordProperty("most_N", std::to_string(max_step_N));
  EXPECT_GT(max_step_N, 2.0) << "they do change";
}

// A hand-over force of 10 N along a motion of 0.1 mm per tick gives the tool 1 mJ per tick, which the tank
// must supply. The planes' springs store nothing in this test.
TEST(HandOver, TheEnergyTankPaysForItsWorkAndScalesItToZeroWhenEmpty) {
  constexpr double kCap_J = 5e-3;
  EnergyTank tank({.cap_J = kCap_J}, kDt_s);
  CouplingOutput out;
  out.fade = 1.0;
  out.active_count = out.active_planes = 1;
  out.active[0].stiffness_N_per_m = kK;
  out.F_hand_over_T_W.f = out.F_contact_T_W.f = Vector3(10.0, 0.0, 0.0);
  const Twist V_WT{.v = Vector3(0.1, 0.0, 0.0), .w = Vector3::Zero()};
  double done_J = 0.0, before_N = 0.0;
  for (int tick = 0; tick <= 12; ++tick) {
    EXPECT_EQ(tank.Step(out, At({1e-4 * tick, 0.0, 0.0}), V_WT, 1.0), 1.0) << "the planes' own go on";
    const double now_N = tank.hand_over_scale() * 10.0;
    if (tick > 0) done_J += 0.5 * (before_N + now_N) * 1e-4;
    before_N = now_N;
    EXPECT_NEAR(tank.energy_J(), std::max(0.0, kCap_J - done_J), 1e-9) << tick;
  }
  EXPECT_GT(done_J, 0.9 * kCap_J);
  EXPECT_LE(done_J, kCap_J + 1e-9);
  EXPECT_LT(tank.hand_over_scale(), 1e-3);
  // a hand-over force opposite to the motion fills the tank
  out.F_hand_over_T_W.f = out.F_contact_T_W.f = Vector3(-10.0, 0.0, 0.0);
  static_cast<void>(tank.Step(out, At({13e-4, 0.0, 0.0}), V_WT, 1.0));
  EXPECT_GT(tank.energy_J(), 0.4e-3);
}

TEST(HandOver, DoesNotAllocate) {
  Bench bench;
  ChangingPlanes planes(3);
  planes.Frame(bench, Vector3::Zero(), 0.4);
  rt::CheckedNoAllocScope scope;
  for (int i = 0; i < 20; ++i) {
    if (i % 3 == 0) {
      bench.model.contacts[0].n_W = Tilted(0.1 * i, 0.0);
      ++bench.model.frame;
    }
    static_cast<void>(bench.Tick(At({0.0, 0.0, -1e-3})));
  }
  scope.End();
}

}  // namespace
}  // namespace osteon::control
