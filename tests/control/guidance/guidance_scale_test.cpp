#include "control/guidance/guidance_scale.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "control/guidance/guidance.h"
#include "control/laws/admittance_law.h"
#include "control/laws/twist_parts.h"
#include "safety/limits.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/control/guidance/guidance_parts.h"

// Tests the guidance's scale, which ensures that the guidance never gives the tool more energy than it took.
// Also tests the guidance as a whole.

namespace osteon::control {
namespace {

constexpr double kDt_s = 1e-3;

// A tool under the admittance law, with guidance and a wrench limiter. The struct also computes the energy
// that the guidance gives to the tool, independently of the guidance: from the rendered wrench and the exact
// motion.
struct GuidedTool {
  explicit GuidedTool(const GuidanceParams& params, const Pose& X_WT) : guidance(params, 0.25, kDt_s) {
    tool.X_WT = X_WT;
    law.mass_kg.setConstant(1.7);
    law.damping_Ns_per_m.setConstant(30.0);
  }

  // Runs one tick. The limiter first admits the bone's wrench; the guidance gets the rest of the limit.
  // @returns the sum of both rendered wrenches
  Wrench Tick(const Wrench& F_hand, const Wrench& F_bone, double model_fade = 1.0) {
    const Wrench F_before = guidance.scale().F_T_W();
    const double proposed =
        guidance.ProposeScale({.X_WT = tool.X_WT, .V_WT = tool.V_WT, .model_fade = model_fade});
    const Wrench& F = guidance.field().F_T_W;
    const Wrench bone = limiter.Limit(F_bone).F;
    const auto sum_with = [&](double share) {
      return Wrench{.f = bone.f + share * F.f, .t = bone.t + share * F.t};
    };
    const double share = MaxFittingScale(ScaleWithin(limiter, bone, F, proposed), [&](double each) {
      return limiter.Limit(sum_with(each)).share >= 1.0;
    });
    limited = limited || share < proposed;
    guidance.AcceptScale(share);
    energy_J += 0.5 * Power(guidance.scale().F_T_W(), step) + 0.5 * Power(F_before, step);
    energy_J = std::max(energy_J, -(guidance.scale().scale() * guidance.field().potential_J + 0.05));
    const Wrench sum = sum_with(share);
    const Pose X_before = tool.X_WT;
    EXPECT_TRUE(StepAdmittance(law, {.f = F_hand.f + sum.f, .t = F_hand.t + sum.t}, kDt_s, tool));
    tool.V_WT = safety::LimitTwist(tool.V_WT, {}).V;
    tool.X_WT = IntegratePose(X_before, tool.V_WT, kDt_s);
    step = Scaled(TwistBetween(X_before, tool.X_WT, kDt_s), kDt_s);
    return sum;
  }
  // Energy given to the tool plus energy still stored [J]. A positive balance would be energy from nothing.
  [[nodiscard]] double Balance_J() const {
    return energy_J + guidance.scale().scale() * guidance.field().potential_J;
  }

  Guidance guidance;
  safety::WrenchLimiter limiter{{}};
  AdmittanceParams law;
  AdmittanceState tool;
  Twist step;
  // energy given to the tool; energy taken in beyond the stored energy + 0.05 J is forgotten
  double energy_J{0.0};
  bool limited{false};
};

// A wrench whose components are uniform between -max and +max (max_N for the force, max_Nm for the torque).
Wrench RandomWrench(std::mt19937& random, double max_N, double max_Nm) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto vector = [&] { return Vector3(unit(random), unit(random), unit(random)); };
  return {.f = max_N * vector(), .t = max_Nm * vector()};
}

// Springs with the least damping that Validate accepts. Then only the energy condition keeps the guidance
// passive.
GuidanceParams HardlyDamped() {
  GuidanceParams params = SomeGuidance();
  params.damping_Ns_per_m = params.damping_Nms_per_rad = 0.0;
  params.return_m_per_s = 1.0;
  params.return_rad_per_s = 10.0;
  return params;
}

// A random hand moves the tool out of the corridor and back, 1000 times. Mostly while the tool moves out, the
// bone's force uses up the limit. So the guidance's scale is small on the way out, and would be large on the
// way back. Without the energy condition, the guidance would give energy in each cycle.
void CycleOutAndBack(const GuidanceParams& params) {
  GuidedTool tool(params, PoseAt(params, {.height_m = 5e-3}));
  std::mt19937 random(3927);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int cycles = 0;
  bool was_inside = true;
  double max_balance_J = -1.0, max_N = 0.0, max_Nm = 0.0, potential_J = 0.0;
  Wrench hand, bone;
  for (int tick = 0; tick < 2'000'000 && cycles < 1000; ++tick) {
    if (tick % 60 == 0) {
      hand = RandomWrench(random, 60.0, 4.0);
      const Vector3 from_planned =
          tool.tool.X_WT.translation() - PoseAt(params, {.height_m = 3e-3}).translation();
      hand.f -= 6e3 * from_planned;  // pulls the tool back to the corridor
      hand.t -= 30.0 * LogRotation(tool.tool.X_WT.linear() * PoseAt(params, {}).linear().transpose());
    }
    if (tick % 5 == 0) {
      const bool leaves = tool.guidance.field().potential_J > potential_J;
      potential_J = tool.guidance.field().potential_J;
      const double bone_N = leaves == (unit(random) < 0.9) ? 300.0 : 20.0;
      bone = {.f = bone_N * params.axis_W, .t = RandomWrench(random, 0.0, 0.05 * bone_N).t};
      hand.f -= hand.f.dot(params.axis_W) * params.axis_W + tool.limiter.Limit(bone).F.f;
    }
    const Wrench sum = tool.Tick(hand, bone);
    max_balance_J = std::max(max_balance_J, tool.Balance_J());
    max_N = std::max(max_N, sum.f.norm());
    max_Nm = std::max(max_Nm, sum.t.norm());
    EXPECT_FALSE(tool.guidance.trips()) << "tick " << tick;
    if (!was_inside && tool.guidance.field().inside) ++cycles;
    was_inside = tool.guidance.field().inside;
  }
  EXPECT_EQ(cycles, 1000);
  EXPECT_TRUE(tool.limited) << "the limiter did not act";
  EXPECT_LE(max_balance_J, 1e-6);
  EXPECT_LE(max_N, 200.0);
  EXPECT_LE(max_Nm, 20.0);
}

TEST(GuidanceScale, NeverGivesMoreThanItTook) { CycleOutAndBack(SomeGuidance()); }
TEST(GuidanceScale, NeverGivesMoreThanItTookWithHardlyAnyDamping) { CycleOutAndBack(HardlyDamped()); }

TEST(GuidanceScale, SwitchedOnOutsideTheCorridorItStaysZeroUntilTheToolIsInside) {
  const GuidanceParams params = SomeGuidance();
  GuidedTool tool(params, PoseAt(params, {.height_m = 2e-3, .aside_m = 10e-3}));
  for (int i = 0; i < 300; ++i) tool.Tick({}, {});
  EXPECT_EQ(tool.guidance.scale().scale(), 0.0);
  EXPECT_FALSE(tool.guidance.acts());
  tool.tool.X_WT = PoseAt(params, {.height_m = 2e-3});
  tool.Tick({}, {});
  EXPECT_EQ(tool.guidance.scale().scale(), 1.0);
}

TEST(GuidanceScale, ResistsAHandThatLeavesTheCorridor) {
  const GuidanceParams params = SomeGuidance();
  GuidedTool guided(params, PoseAt(params, {.height_m = 1e-3}));
  const Wrench deeper{.f = -60.0 * params.axis_W};
  for (int i = 0; i < 2000; ++i) guided.Tick(deeper, {});
  // the hand's 60 N act against the depth spring of 10 N/mm, which rises gradually within the first 0.5 mm
  // (its ease): 60/10 + 0.5/2 = 6.25 mm
  EXPECT_NEAR(guided.guidance.field().excess.depth_m, 6.25e-3, 0.05e-3);
  EXPECT_EQ(guided.guidance.scale().scale(), 1.0);
  EXPECT_LT(guided.energy_J, 0.0);
}

TEST(GuidanceScale, YieldsToTheBonesForce) {
  const GuidanceParams params = SomeGuidance();
  GuidedTool tool(params, PoseAt(params, {.height_m = 1e-3}));
  for (int i = 0; i < 1000; ++i) tool.Tick({.f = -80.0 * params.axis_W}, {});
  ASSERT_GT(tool.guidance.scale().F_T_W().f.norm(), 70.0);
  // now the bone's force alone reaches the limit of 200 N, in the same direction
  const Wrench sum = tool.Tick({}, {.f = 250.0 * params.axis_W});
  EXPECT_LT(tool.guidance.scale().F_T_W().f.norm(), 0.01);
  EXPECT_LE(sum.f.norm(), 200.0);
  // the bone's force vanishes. The guidance's scale then rises from 0 to 1 within 0.1 s, thus by 0.01 per
  // tick
  tool.Tick({}, {});
  EXPECT_LE(tool.guidance.scale().scale(), 0.011);
}

TEST(GuidanceScale, ScaleWithinIsTheLargestScaleThatFits) {
  const safety::WrenchLimiter limiter({.max_force_N = 100.0, .max_torque_Nm = 5.0});
  std::mt19937 random(5);
  int by_limit = 0;
  for (int i = 0; i < 1000; ++i) {
    const Wrench other = limiter.Limit(RandomWrench(random, 150.0, 6.0)).F;
    const Wrench guidance = RandomWrench(random, 100.0, 5.0);
    const auto sum = [&](double share) {
      return Wrench{.f = other.f + share * guidance.f, .t = other.t + share * guidance.t};
    };
    const double share = ScaleWithin(limiter, other, guidance, 1.0);
    EXPECT_EQ(limiter.Limit(sum(std::max(0.0, share - 1e-6))).share, 1.0);
    if (share == 1.0) continue;
    ++by_limit;
    EXPECT_LT(limiter.Limit(sum(share + 1e-6)).share, 1.0) << "a greater share does not fit";
  }
  EXPECT_GT(by_limit, 200);
  EXPECT_EQ(ScaleWithin(limiter, {.f = {150.0, 0.0, 0.0}}, {.f = {-1.0, 0.0, 0.0}}, 1.0), 0.0);
}

TEST(GuidanceScale, FadesWithTheModelsAge) {
  const GuidanceParams params = SomeGuidance();
  GuidedTool tool(params, PoseAt(params, {.height_m = 1e-3}));
  const Wrench deeper{.f = -40.0 * params.axis_W};
  for (int i = 0; i < 1000; ++i) tool.Tick(deeper, {});
  ASSERT_GT(tool.guidance.scale().scale(), 0.99);
  tool.Tick(deeper, {}, 0.25);
  EXPECT_EQ(tool.guidance.scale().scale(), 0.25);
  tool.Tick(deeper, {}, 0.0);
  EXPECT_EQ(tool.guidance.scale().scale(), 0.0);
  EXPECT_FALSE(tool.guidance.acts());
}

TEST(GuidanceScale, AToolLetGoOutsideReturnsSlowly) {
  GuidanceParams params = SomeGuidance();
  GuidedTool tool(params, PoseAt(params, {.height_m = 3e-3}));
  const Vector3 aside = PoseAt(params, {.aside_m = 1.0}).translation() - PoseAt(params, {}).translation();
  for (int i = 0; i < 20000; ++i) {
    const double at_m =
        (tool.tool.X_WT.translation() - PoseAt(params, {.height_m = 3e-3}).translation()).dot(aside);
    if (at_m >= 17e-3) break;
    tool.Tick({.f = 70.0 * aside}, {});
  }
  ASSERT_GT(tool.guidance.field().excess.lateral_m, 10e-3);
  tool.tool.V_WT = {};
  double fastest_m_per_s = 0.0;
  for (int i = 0; i < 2000; ++i) {
    tool.Tick({}, {});
    fastest_m_per_s = std::max(fastest_m_per_s, tool.tool.V_WT.v.norm());
  }
  EXPECT_TRUE(tool.guidance.field().inside) << "it does come back";
  EXPECT_LE(fastest_m_per_s, 0.06);
}

TEST(Guidance, StopsTheSpindleBeyondItsStopUntilTheToolIsInside) {
  GuidanceParams params = SomeGuidance();
  Guidance guidance(params, 0.25, kDt_s);
  const auto at = [&](const CorridorPlace& place) {
    guidance.AcceptScale(guidance.ProposeScale({.X_WT = PoseAt(params, place)}));
    return guidance.stops_spindle();
  };
  EXPECT_FALSE(at({.height_m = 1e-3}));
  EXPECT_FALSE(at({.height_m = 1e-3, .aside_m = 2.5e-3})) << "outside, but before the stop";
  EXPECT_TRUE(at({.height_m = 1e-3, .aside_m = 3.5e-3}));
  EXPECT_TRUE(at({.height_m = 1e-3, .aside_m = 2.5e-3})) << "until inside";
  EXPECT_FALSE(at({.height_m = 1e-3}));
  EXPECT_TRUE(at({.height_m = 1e-3, .tilt_rad = 0.18}));
  guidance.SetGain(0.0);
  EXPECT_FALSE(at({.height_m = 1e-3, .tilt_rad = 0.18})) << "off";
  params.stops_spindle = false;
  Guidance free(params, 0.25, kDt_s);
  free.AcceptScale(free.ProposeScale({.X_WT = PoseAt(params, {.tilt_rad = 0.3})}));
  EXPECT_FALSE(free.stops_spindle());
}

TEST(Guidance, TripsWhenItsForceJumps) {
  const GuidanceParams params = SomeGuidance();
  Guidance guidance(params, 0.25, kDt_s);
  guidance.AcceptScale(guidance.ProposeScale({.X_WT = PoseAt(params, {.height_m = 1e-3})}));
  EXPECT_FALSE(guidance.trips());
  guidance.AcceptScale(guidance.ProposeScale({.X_WT = PoseAt(params, {.height_m = -3e-3})}));
  EXPECT_TRUE(guidance.trips()) << "4 mm in a tick";
}

TEST(Guidance, DoesNotAllocate) {
  const GuidanceParams params = SomeGuidance();
  GuidedTool tool(params, PoseAt(params, {.height_m = 1e-3}));
  const Wrench hand{.f = -60.0 * params.axis_W, .t = {1.0, 2.0, 0.0}};
  tool.Tick(hand, {});
  TickRecord record;
  {
    const rt::CheckedNoAllocScope scope;
    for (int i = 0; i < 200; ++i) {
      static_cast<void>(
          tool.guidance.ProposeScale({.X_WT = tool.tool.X_WT, .V_WT = tool.tool.V_WT, .model_fade = 1.0}));
      tool.guidance.AcceptScale(1.0);
    }
    record.guidance = tool.guidance.Record();
    const Guidance prepared = tool.guidance;
    tool.guidance.Reset();
    tool.guidance = prepared;
  }
  EXPECT_TRUE(record.guidance.present);
}

}  // namespace
}  // namespace osteon::control
