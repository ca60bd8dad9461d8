#include <cmath>

#include <gtest/gtest.h>

#include "control/coupling/coupling_pipeline.h"
#include "control/loop/loop_repeat.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/control/loop/servo_parts.h"

// Tests a compliant tool, bone mount and surface layer in the coupling's pipeline and in the whole servo
// loop.

namespace osteon::control {
namespace {

constexpr double kK_N_per_m = 20e3;  // the coupling's stiffness in ServoBench

// A tool that is as stiff as the coupling, 20 N/mm both along its feed and across it.
ToolLinkParams SoftTool() {
  ToolLinkParams tool;
  tool.compliance_T.diagonal().setConstant(1.0 / kK_N_per_m);
  return tool;
}

// A mount of this stiffness along each axis, with its pivot at the bench's start pose.
BoneMountParams Mount(double stiffness_N_per_m) {
  BoneMountParams mount;
  mount.p_WMo_m = ServoBench::StartPose().translation();
  mount.stiffness_N_per_m.setConstant(stiffness_N_per_m);
  mount.damping_ratio = 0.3;
  return mount;
}

// The coupling's pipeline with a tool that is held `depth_m` deep in bone.
struct HeldTool {
  explicit HeldTool(const ServoParams& p) : params(p), arm(Follower(params)), pipeline(params) {
    pipeline.Reset();
  }
  safety::LimitedWrench Tick(double depth_m) {
    now += rt::kMillisecond;
    return Tick(PlaneBehind(depth_m, now));
  }
  safety::LimitedWrench Tick(const simulation::ContactModel& model) {
    safety::LimitSet acting;
    static_cast<void>(pipeline.Evaluate(
        {.model = model, .X_WT = arm->X_WT(), .V_WT = {}, .now = now, .spindle_turns = false}, *arm, acting));
    const safety::LimitedWrench rendered = pipeline.Render(*arm, acting);
    pipeline.StepCompliance(model, acting);
    return rendered;
  }
  // Runs 800 ticks, until the coupling has faded in and all elements are at rest.
  safety::LimitedWrench Settle(double depth_m) {
    safety::LimitedWrench rendered;
    for (int i = 0; i < 800; ++i) rendered = Tick(depth_m);
    return rendered;
  }
  ServoParams params;
  std::unique_ptr<ArmFollower> arm;
  CouplingPipeline pipeline;
  rt::Nanoseconds now{rt::kSecond};
};

// The tool and the coupling are two springs of 20 N/mm in series: at 2 mm the force is 20 N instead of 40 N.
TEST(CompliantCoupling, AToolAsSoftAsTheCouplingHalvesTheForce) {
  ServoParams params = ServoBench::Params();
  params.compliance.tool = SoftTool();
  HeldTool held(params);
  EXPECT_NEAR(held.Settle(2e-3).F.f.norm(), 20.0, 0.2) << "of 40 N of a rigid tool";
  ASSERT_NE(held.pipeline.compliance(), nullptr);
  EXPECT_NEAR(held.pipeline.compliance()->bend().z(), -1e-3, 1e-5);
}

TEST(CompliantCoupling, AMountAsSoftAsTheCouplingHalvesTheForce) {
  ServoParams params = ServoBench::Params();
  params.compliance.mount = Mount(kK_N_per_m);
  HeldTool held(params);
  EXPECT_NEAR(held.Settle(2e-3).F.f.norm(), 20.0, 0.2);
}

TEST(CompliantCoupling, ALayerDoesNotYieldToPlanesOutsideIt) {
  ServoParams params = ServoBench::Params();
  SurfaceLayerParams layer;
  layer.kappa_N_per_m3[0] = 0.06e9;
  layer.thickness_m = 0.02;
  layer.tau_s = 0.05;
  params.compliance.layer = layer;
  HeldTool held(params);
  // the bench's plane lies in no layer (its weight is 0), so the force equals that of a rigid cell
  EXPECT_NEAR(held.Settle(2e-3).F.f.norm(), 40.0, 0.4);
}

TEST(CompliantCoupling, ElementsWithoutComplianceChangeNothing) {
  ServoParams rigid = ServoBench::Params(), still = rigid;
  ToolLinkParams tool;
  tool.tau_s = 0.02;
  still.compliance.tool = tool;
  HeldTool rigid_tool(rigid), still_tool(still);
  for (int i = 0; i < 400; ++i) {
    const double depth_m = 1e-3 * (1.0 + std::sin(0.05 * i));
    const Wrench F_a = rigid_tool.Tick(depth_m).F, F_b = still_tool.Tick(depth_m).F;
    ASSERT_LT((F_a.f - F_b.f).norm(), 1e-9) << i;
    ASSERT_LT((F_a.t - F_b.t).norm(), 1e-9) << i;
  }
}

// A tool that is as soft as the coupling stores as much energy as the coupling. Therefore the force limit is
// reduced by the factor sqrt(2).
TEST(CompliantCoupling, TheElementsEnergyLowersTheForceLimit) {
  ServoParams params = ServoBench::Params();
  params.energy.max_stored_J = 0.1;
  const double rigid_N = ForceLimit_N(params);
  params.compliance.tool = SoftTool();
  EXPECT_NEAR(ForceLimit_N(params), rigid_N / std::sqrt(2.0), 1e-9);
  HeldTool held(params);
  held.Settle(1e-3);
  double force_N = 0.0;
  for (int i = 0; i < 3000; ++i) force_N = held.Tick(1e-3 + 2e-6 * i).F.f.norm();
  EXPECT_LE(force_N, ForceLimit_N(params) * (1.0 + 1e-12));
  EXPECT_GT(force_N, 0.95 * ForceLimit_N(params));
}

TEST(CompliantCoupling, TheForceCeilingHoldsWithCompliantParts) {
  ServoParams params = ServoBench::Params();
  params.compliance.tool = SoftTool();
  params.compliance.mount = Mount(50e3);
  HeldTool held(params);
  for (int i = 0; i < 800; ++i) ASSERT_LE(held.Tick(50e-3).F.f.norm(), safety::kForceCeiling_N);
}

TEST(CompliantCoupling, DoesNotAllocate) {
  ServoParams params = ServoBench::Params();
  params.compliance = {.layer = SurfaceLayerParams{}, .tool = SoftTool(), .mount = Mount(50e3)};
  HeldTool held(params);
  held.Settle(1e-3);
  const simulation::ContactModel model = PlaneBehind(1e-3, held.now);
  const rt::CheckedNoAllocScope scope;
  held.Tick(model);
}

// A hand presses with 40 N on bone whose mount has a stiffness of 40 N/mm, so the bone moves by 1 mm.
TEST(CompliantLoop, AHandMovesTheBoneByForceOverStiffness) {
  constexpr double kPush_N = 40.0, kMount_N_per_m = 40e3;
  ServoParams params = ServoBench::Params();
  params.compliance.mount = Mount(kMount_N_per_m);
  ServoBench bench(params, 0.001);
  bench.Activate();
  bench.push_N = kPush_N;
  const TickRecord record = bench.Run(4000);
  ASSERT_FALSE(bench.loop.faults().Any());
  ASSERT_TRUE(record.compliance.present);
  EXPECT_NEAR(bench.feed_W.dot(Vector3(record.compliance.mount_m)), kPush_N / kMount_N_per_m, 3e-5);
  const double apex_m = bench.feed_W.dot(Vector3(record.X_WT_cmd.p) - bench.plane_W);
  EXPECT_NEAR(apex_m, kPush_N / kK_N_per_m + kPush_N / kMount_N_per_m, 1e-4);
  EXPECT_NEAR(bench.Depth(), kPush_N / kK_N_per_m, 1e-4) << "the engine is given the depth in bone";
  EXPECT_TRUE(safety::LimitSet(record.limits).Has(safety::Limit::kDeflection));
}

TEST(CompliantLoop, ABendBeyondItsLimitStopsTheCell) {
  ServoParams params = ServoBench::Params();
  params.compliance.tool = SoftTool();
  params.compliance.tool->max_thrust_N = 30.0;
  ServoBench bench(params, 0.001);
  bench.Activate();
  bench.push_N = 40.0;
  bench.Run(3000);
  EXPECT_TRUE(bench.loop.faults().Has(safety::Fault::kDeflection));
  EXPECT_EQ(bench.loop.phase(), Phase::kStopped);
}

// A second loop computes every tick again from the tick's record. The results must be equal in every bit.
TEST(CompliantLoop, EveryTickCanBeReplayedBitForBit) {
  ServoParams params = ServoBench::Params();
  params.compliance = {.tool = SoftTool(), .mount = Mount(40e3)};
  ServoBench bench(params, 0.001);
  ServoLoop second(params, ServoBench::Arm(), Pose::Identity(), ServoBench::FlangeToTool(),
                   ServoBench::Arm().ArmAngle(ServoBench::StartJoints()));
  LoopRepeat repeat(second);
  bench.Activate();
  for (int i = 0; i < 1500; ++i) {
    bench.push_N = 30.0 + 10.0 * std::sin(0.02 * i);
    bench.side_W_N = Vector3(0.0, 8.0 * std::sin(0.013 * i), 0.0);
    repeat.StoreTick(bench.Tick(), bench.model);
    ASSERT_TRUE(repeat.ReplayStoredTick()) << i;
  }
  EXPECT_FALSE(bench.loop.faults().Any());
}

// The depth bound is fixed either to the bone (rides_on_bone) or to the world. Bone on a soft mount moves
// away from the tool. This motion counts as depth only if the bound is fixed to the world.
TEST(CompliantLoop, ADepthBoundFixedToTheBoneMovesWithTheBone) {
  ServoParams params = ServoBench::Params();
  params.compliance.mount = Mount(20e3);
  params.depth.acts = true;
  params.depth.soft_m = 0.5e-3;
  params.depth.spindle_stop_m = 0.2e-3;
  const Pose X_start = ServoBench::StartPose();
  const Vector3 feed_W = X_start.linear().col(2);
  params.depth.bound.shape = safety::ZoneShape::kHalfSpace;
  params.depth.bound.R_W = RotationFromZTo(Vector3(-feed_W));
  params.depth.bound.p_W_m = Vector3(X_start.translation() + 3.0e-3 * feed_W);
  const auto distance_m = [&](bool moves_with_bone) {
    params.depth.rides_on_bone = moves_with_bone;
    ServoBench bench(params, 0.001);
    bench.Activate();
    for (int i = 0; i < 4000; ++i) {
      bench.push_N = 20.0 * std::min(1.0, i / 3000.0);
      bench.Tick();
    }
    EXPECT_FALSE(bench.loop.faults().Any());
    // the apex moves by 1 mm + F/K + F/k = 3 mm from the start, with the force F and the stiffnesses K of the
    // coupling and k of the mount; relative to the bone it moves by 2 mm
    return bench.loop.statistics().min_depth_left_m;
  };
  EXPECT_NEAR(distance_m(true), 1.0e-3, 0.1e-3);
  EXPECT_LT(distance_m(false), 0.6e-3) << "a bound at rest counts the bone's motion as depth";
}

}  // namespace
}  // namespace osteon::control
