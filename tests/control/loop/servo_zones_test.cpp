#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"
#include "tests/control/loop/servo_bench.h"

// Tests limits in the whole servo loop: zones of apex, flange and elbow, the depth limit, and limits of
// energy, speed and power.

namespace osteon::control {
namespace {

using safety::Fault;
using safety::Limit;
using safety::ZoneParams;
using safety::ZonePoint;
using safety::ZoneShape;
using safety::ZoneSide;

// Position of the elbow in a posture, in the world [m]; below, those of the flange and of the tool's apex.
Vector3 Elbow(const JointArray& q) {
  return ServoBench::Arm().Points(Eigen::Map<const kinematics::JointVector>(q.data())).p_BElbow;
}
Vector3 Flange(const JointArray& q) {
  return ServoBench::Arm().FlangePose(Eigen::Map<const kinematics::JointVector>(q.data())).translation();
}
JointArray StartArray() {
  JointArray q;
  Eigen::Map<kinematics::JointVector>(q.data()) = ServoBench::StartJoints();
  return q;
}

// A zone for one of the arm's points. The zone is a half-space whose wall is distance_m away from p_W, in the
// direction way_W.
ZoneParams Wall(ZonePoint point, const Vector3& p_W, const Vector3& way_W, double distance_m) {
  return {.shape = ZoneShape::kHalfSpace,
          .side = ZoneSide::kKeepIn,
          .point = point,
          .p_W_m = p_W + distance_m * way_W,
          .R_W = RotationFromZTo(-way_W)};
}

// A hand pushes the tool at random, mostly toward a wall. The wall is 10 mm from the flange or the elbow.
TEST(ServoZones, FlangeAndElbowStayInTheirZones) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  const JointArray start = StartArray();
  for (const ZonePoint point : {ZonePoint::kFlange, ZonePoint::kElbow}) {
    const Vector3 p_W = point == ZonePoint::kFlange ? Flange(start) : Elbow(start);
    std::uint64_t acted = 0;
    for (int i = 0; i < 6; ++i) {
      const Vector3 toward_wall_W = Vector3(any(random), any(random), any(random)).normalized();
      ServoParams params = ServoBench::Params();
      params.workspace.sphere_radius_m = 0.5;
      params.workspace.plane_offset_m = -1.0;
      params.workspace.zones = {Wall(point, p_W, toward_wall_W, 0.01)};
      ServoBench bench(params, 10.0);
      bench.Run(3);
      bench.Activate();
      for (int tick = 0; tick < 1500; ++tick) {
        if (tick % 250 == 0) {
          bench.side_W_N = 40.0 * toward_wall_W + 30.0 * Vector3(any(random), any(random), any(random));
          bench.push_N = 30.0 * any(random);
        }
        const TickRecord record = bench.Tick();
        const Vector3 now = point == ZonePoint::kFlange ? Flange(record.q_cmd) : Elbow(record.q_cmd);
        ASSERT_LE((now - p_W).dot(toward_wall_W), 0.01 + 1e-8) << "wall " << i << ", tick " << tick;
      }
      EXPECT_FALSE(bench.loop.faults().Any());
      acted += bench.loop.statistics().limits.Of(Limit::kZones).ticks;
    }
    EXPECT_GT(acted, 100u) << "some hand came to its wall";
  }
}

Vector3 PositionOf(ZonePoint point, const JointArray& q) {
  if (point == ZonePoint::kElbow) return Elbow(q);
  if (point == ZonePoint::kFlange) return Flange(q);
  return (ServoBench::Arm().FlangePose(Eigen::Map<const kinematics::JointVector>(q.data())) *
          ServoBench::FlangeToTool())
      .translation();
}

// Parameters with a wall that lies 20 mm in +y from the start of this point of the arm.
ServoParams WithWallBeside(ZonePoint point) {
  ServoParams params = ServoBench::Params();
  params.workspace.sphere_radius_m = 0.5;
  params.workspace.plane_offset_m = -1.0;
  params.workspace.zones = {Wall(point, PositionOf(point, StartArray()), Vector3::UnitY(), 0.02)};
  return params;
}
// Distance of the point beyond the wall of WithWallBeside [m]; negative inside the zone.
double DistancePastWall_m(ZonePoint point, const JointArray& q) {
  return (PositionOf(point, q) - PositionOf(point, StartArray())).y() - 0.02;
}

// A hand pushes the tool toward the wall, and a stop is requested at different moments. Each point must come
// to rest inside its zone.
TEST(ServoZones, AStopEndsInsideTheZones) {
  for (const ZonePoint point : {ZonePoint::kApex, ZonePoint::kFlange, ZonePoint::kElbow})
    for (int moment = 40; moment < 400; moment += 40) {
      ServoParams params = WithWallBeside(point);
      // the rotation brakes so slowly that it takes longer to stop than the distance to the wall allows
      params.stop_deceleration_rad_per_s2 = 2.0;
      ServoBench bench(params, 10.0);
      bench.Run(3);
      bench.Activate();
      bench.side_W_N = {0.0, 60.0, 0.0};
      bench.Run(moment);
      bench.loop.RequestStop();
      for (int tick = 0; tick < 1500; ++tick)
        ASSERT_LE(DistancePastWall_m(point, bench.Tick().q_cmd), 1e-8)
            << static_cast<int>(point) << " stopped at " << moment;
      EXPECT_EQ(bench.loop.phase(), Phase::kStopped);
    }
}

// A stop may also brake each joint by a ramp of fixed duration, whatever the distance to the wall. It must
// end inside the zone as well.
TEST(ServoZones, AStopAlongTheJointsEndsInsideTheZones) {
  for (const ZonePoint point : {ZonePoint::kApex, ZonePoint::kFlange, ZonePoint::kElbow}) {
    ServoParams params = WithWallBeside(point);
    params.joint_stop_s = 0.5;
    for (int moment = 20; moment < 200; moment += 20) {
      const auto arm = MakeFollower(params, ServoBench::Arm(), Pose::Identity(), ServoBench::FlangeToTool(),
                                    ServoBench::Arm().ArmAngle(ServoBench::StartJoints()));
      arm->ResetTo(StartArray());
      arm->StartFollowing();
      const safety::Workspace apex(params.workspace);
      for (int tick = 0; tick < moment; ++tick) {
        const Vector3 v = apex.Limit(arm->X_WT().translation(), {0.0, 0.2, 0.0}, params.period_s).v_WT;
        ASSERT_EQ(arm->Follow({.V_WT = {.v = v, .w = Vector3::Zero()}}).fault, Fault::kNone);
      }
      for (int tick = 0; tick < 600 && !arm->BrakeJoints(); ++tick)
        ASSERT_LE(DistancePastWall_m(point, arm->q()), 1e-8)
            << static_cast<int>(point) << " stopped at " << moment;
      EXPECT_LE(DistancePastWall_m(point, arm->q()), 1e-8);
    }
  }
}

// A stop that brakes the joints must also end before the depth limit, although its bound is not one of the
// cell's zones.
TEST(ServoZones, AStopAlongTheJointsEndsBeforeTheDepthLimit) {
  ServoParams params = WithWallBeside(ZonePoint::kApex);
  params.depth = {.acts = true, .bound = params.workspace.zones.front()};
  params.workspace.zones.clear();
  params.joint_stop_s = 0.5;
  const safety::Workspace bound(WorkspaceOf(params));
  const auto arm = MakeFollower(params, ServoBench::Arm(), Pose::Identity(), ServoBench::FlangeToTool(),
                                ServoBench::Arm().ArmAngle(ServoBench::StartJoints()));
  arm->ResetTo(StartArray());
  arm->StartFollowing();
  for (int tick = 0; tick < 60; ++tick) {
    const Vector3 v = bound.Limit(arm->X_WT().translation(), {0.0, 0.2, 0.0}, params.period_s).v_WT;
    ASSERT_EQ(arm->Follow({.V_WT = {.v = v, .w = Vector3::Zero()}}).fault, Fault::kNone);
  }
  for (int tick = 0; tick < 600 && !arm->BrakeJoints(); ++tick)
    ASSERT_LE(DistancePastWall_m(ZonePoint::kApex, arm->q()), 1e-8) << tick;
}

TEST(ServoZones, ADepthLimitResistsThenStopsTheSpindleThenHolds) {
  ServoParams params = ServoBench::Params();
  params.spindle_rad_per_s = 20.0;
  params.workspace.sphere_radius_m = 0.5;
  params.workspace.plane_offset_m = -1.0;
  const Vector3 feed_W = ServoBench::StartPose().linear().col(2);
  params.depth = {.acts = true,
                  .bound = Wall(ZonePoint::kApex, ServoBench::StartPose().translation(), feed_W, 0.012),
                  .soft_m = 6e-3,
                  .spindle_stop_m = 2e-3,
                  .stiffness_N_per_m = 10e3};
  ServoBench bench(params, 10.0);
  bench.Run(3);
  bench.Activate();
  const auto depth_m = [&](const TickRecord& record) {
    return (Vector3(Pose(record.X_WT_cmd).translation()) - ServoBench::StartPose().translation()).dot(feed_W);
  };
  TickRecord record;
  const auto press = [&](double from_N, double to_N) {  // slowly, to avoid oscillation
    for (int i = 0; i <= 3000; ++i) {
      bench.push_N = from_N + (to_N - from_N) * std::min(1.0, i / 2000.0);
      record = bench.Tick();
    }
  };
  press(0.0, 30.0);  // the soft zone's spring of 10 kN/m balances 30 N at 3 mm, which is 9 mm from the start
  EXPECT_NEAR(depth_m(record), 0.009, 0.2e-3);
  EXPECT_EQ(bench.loop.cell_commands().spindle_rad_per_s, 20.0);
  EXPECT_TRUE(safety::LimitSet(record.limits).Has(Limit::kDepth));
  press(30.0, 50.0);
  EXPECT_NEAR(depth_m(record), 0.011, 0.2e-3);
  EXPECT_EQ(bench.loop.cell_commands().spindle_rad_per_s, 0.0) << "within 2 mm of the bound";
  press(50.0, 190.0);
  EXPECT_NEAR(depth_m(record), 0.012, 1e-5) << "the bound itself";
  bench.push_N = -20.0;
  bench.Run(10);
  EXPECT_EQ(bench.loop.cell_commands().spindle_rad_per_s, 0.0) << "until it is out of the soft zone";
  bench.Run(1000);
  EXPECT_EQ(bench.loop.cell_commands().spindle_rad_per_s, 20.0);
  EXPECT_FALSE(bench.loop.faults().Any());
}

// A hand presses with 100 N, which would store 1 J in a spring of k = 5 kN/m. If the stored energy is limited
// to E, the force must stay below sqrt(2 k E).
TEST(ServoLimits, TheLimitOfStoredEnergyBoundsTheForce) {
  const auto max_force_N = [](double energy_J, double stiffness_N_per_m) {
    ServoParams params = ServoBench::Params();
    params.coupling.max_stiffness_N_per_m = stiffness_N_per_m;
    params.energy.max_stored_J = energy_J;
    ServoBench bench(params, 0.001);
    bench.Run(3);
    bench.Activate();
    double max_N = 0.0;
    for (int tick = 0; tick < 3000; ++tick) {
      bench.push_N = std::min(100.0, 0.05 * tick);
      max_N = std::max(max_N, Vector3(bench.Tick().F_coupling_T_W.f).norm());
    }
    EXPECT_FALSE(bench.loop.faults().Any());
    EXPECT_EQ(bench.loop.statistics().limits.Of(Limit::kStoredEnergy).ticks > 0, max_N < 99.0);
    return max_N;
  };
  EXPECT_NEAR(max_force_N(0.25, 5e3), std::sqrt(2.0 * 5e3 * 0.25), 1e-6);
  EXPECT_GT(max_force_N(1.5, 5e3), 99.0) << "more than the hand asks for";
}

// The tool's speed has three bounds: the cell's 0.4 m/s, 0.25 m/s in operating mode T1 (value 0), and the
// bound that follows from the kinetic energy. The lowest one must hold.
TEST(ServoLimits, TheTightestBoundOfTheToolsSpeedHolds) {
  const auto peak_speed_m_per_s = [](double energy_J, std::uint8_t mode) {
    ServoParams params = ServoBench::Params();
    params.twist.max_speed_m_per_s = 0.4;
    params.model_sight_m = 5e-3;  // the frames are 2 ms old
    params.workspace.sphere_radius_m = 0.5;
    params.energy.max_kinetic_J = energy_J;
    params.energy.moving_mass_kg = 10.0;
    ServoBench bench(params, 10.0);
    bench.arm.operation_mode = mode;
    bench.Run(3);
    bench.Activate();
    bench.side_W_N = {0.0, 40.0, 0.0};
    bench.Run(600);
    EXPECT_FALSE(bench.loop.faults().Any());
    return bench.loop.statistics().peak_tool_speed_m_per_s;
  };
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_NEAR(peak_speed_m_per_s(infinite, 2), 0.4, 1e-3) << "the cell's";
  EXPECT_NEAR(peak_speed_m_per_s(infinite, 0), 0.25, 1e-3) << "reduced speed in T1";
  EXPECT_NEAR(peak_speed_m_per_s(0.2, 2), 0.2, 1e-3) << "10 kg at .2 m/s";
  EXPECT_NEAR(peak_speed_m_per_s(0.2, 0), 0.2, 1e-3);
}

// The elbow's speed limit of 0.02 m/s allows 0.02 mm in a tick of 1 ms, however hard the hand pushes the
// tool.
TEST(ServoLimits, TheElbowKeepsItsOwnSpeedLimit) {
  ServoParams params = ServoBench::Params();
  params.workspace.sphere_radius_m = 0.5;
  params.max_elbow_speed_m_per_s = 0.02;
  ServoBench bench(params, 10.0);
  bench.arm.operation_mode = 2;
  bench.Run(3);
  bench.Activate();
  bench.side_W_N = {0.0, 60.0, 0.0};
  Vector3 before = Elbow(StartArray());
  for (int tick = 0; tick < 800; ++tick) {
    const Vector3 elbow = Elbow(bench.Tick().q_cmd);
    ASSERT_LE((elbow - before).norm(), 0.02e-3 * (1.0 + 1e-3)) << tick;
    before = elbow;
  }
  EXPECT_GT(bench.loop.statistics().limits.Of(Limit::kElbowSpeed).ticks, 100u);
  EXPECT_FALSE(bench.loop.faults().Any());
}

// A spring that throws the tool back must not give the hand more than the permitted power. The test computes
// the power from the commanded poses before and after each tick, and not from the velocity that the limit
// uses.
TEST(ServoLimits, PowerIntoTheHandIsBounded) {
  const auto max_power_W = [](double limit_W) {
    ServoParams params = ServoBench::Params();
    params.energy.max_power_W = limit_W;
    ServoBench bench(params, 0.001);
    bench.Run(3);
    bench.Activate();
    bench.push_N = 150.0;
    bench.Run(2000);
    bench.push_N = 0.0;  // the hand releases
    double max_W = 0.0;
    Pose before = bench.loop.tool_command().X_WT;
    for (int tick = 0; tick < 300; ++tick) {
      const TickRecord record = bench.Tick();
      const Pose after = bench.loop.tool_command().X_WT;
      const Vector3 moved = after.translation() - before.translation();
      const Vector3 turned = LogRotation(after.linear() * before.linear().transpose());
      const double work_J =
          Vector3(record.F_coupling_T_W.f).dot(moved) + Vector3(record.F_coupling_T_W.t).dot(turned);
      max_W = std::max(max_W, work_J / 1e-3);
      before = after;
    }
    return max_W;
  };
  EXPECT_GT(max_power_W(std::numeric_limits<double>::infinity()), 20.0) << "there is something to bound";
  // a tolerance of 0.1 %, because the tool's motion follows from rounded joint positions
  EXPECT_LE(max_power_W(12.0), 12.0 * 1.001);
  EXPECT_LE(max_power_W(5.0), 5.0 * 1.001);
}

TEST(ServoZones, TheTickAllocatesNothingWithZonesAndDepthLimit) {
  ServoParams params = ServoBench::Params();
  const JointArray start = StartArray();
  params.workspace.zones = {Wall(ZonePoint::kFlange, Flange(start), Vector3::UnitY(), 1e-3),
                            Wall(ZonePoint::kElbow, Elbow(start), Vector3::UnitY(), 1e-3),
                            {.shape = ZoneShape::kBox, .side = ZoneSide::kKeepOut, .p_W_m = {9.0, 9.0, 9.0}}};
  params.depth = {
      .acts = true,
      .bound = Wall(ZonePoint::kApex, ServoBench::StartPose().translation(), Vector3::UnitY(), 3e-3)};
  ServoBench bench(params, 10.0);
  bench.Run(3);
  bench.Activate();
  bench.side_W_N = {0.0, 60.0, 0.0};
  bench.Run(50);
  rt::CheckedNoAllocScope no_alloc;
  bench.Run(100);
  no_alloc.End();
  EXPECT_GT(bench.loop.statistics().limits.Of(Limit::kZones).ticks, 10u);
}

}  // namespace
}  // namespace osteon::control
