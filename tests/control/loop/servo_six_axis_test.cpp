// Tests the servo loop with a six-axis KR arm at RSI's period of 4 ms. Law and limits are the same as for an
// LBR, but the arm has no redundant elbow.

#include <gtest/gtest.h>

#include "control/loop/servo_loop.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/control/loop/servo_bench.h"
#include "tests/kinematics/kr_arms.h"

namespace osteon::control {
namespace {

using kinematics::OrthoParallelArm;
using Joints = OrthoParallelArm::Joints;

constexpr double kPeriod_s = 0.004;
constexpr double kStiffness_N_per_m = 5e3;  // stiffness of the coupling and of the bench's plane

Joints StartJoints() {
  Joints q;
  q << 0.1, -1.5, 1.6, 0.2, 1.2, 0.3;
  return q;
}

OrthoParallelArm Arm() {
  kinematics::OrthoParallelParams params = kinematics::Kr16Params();
  for (kinematics::JointLimits& limit : params.limits)
    limit.acceleration_rad_per_s2 =
        limit.velocity_rad_per_s / 0.3;  // 0.3 s to reach full speed, as assumed in the robot's file
  return OrthoParallelArm(params);
}

// Tool pose at these joints.
Pose PoseAt(const Joints& q) {
  // constructed once, because the construction allocates and PoseAt is called where allocations are checked
  static const OrthoParallelArm arm = Arm();
  return arm.FlangePose(q) * ServoBench::FlangeToTool();
}

ServoParams Params() {
  const Vector3 p_start = PoseAt(StartJoints()).translation();
  ServoParams params;
  params.period_s = kPeriod_s;
  std::copy_n(Arm().params().limits.begin(), 6, params.joints.limits.begin());
  params.workspace.sphere_center_W_m = p_start;
  params.workspace.sphere_radius_m = 0.3;
  params.workspace.plane_offset_m = p_start.z() - 0.3;
  params.admittance.damping_Ns_per_m.setConstant(120.0);  // the damping D must exceed a_max K (largest age
                                                          // times stiffness) to be stable at a period of 4 ms
  params.coupling.max_stiffness_N_per_m = kStiffness_N_per_m;
  params.spindle_rad_per_s = 0.0;
  return params;
}

// A servo loop in virtual time with a KR 16 that follows its command one tick later, and with a hand. A plane
// lies 5 mm ahead of the tool and is reported without delay.
class SixAxisBench {
 public:
  explicit SixAxisBench(const ServoParams& params = Params(), const Joints& q = StartJoints())
      : loop(params, Arm(), Pose::Identity(), ServoBench::FlangeToTool()) {
    std::copy_n(q.data(), 6, arm.q_meas.begin());
    arm.session = SessionState::kCommandingActive;
    arm.period_s = kPeriod_s;
    arm.activation = 1;
    feed_W = PoseAt(StartJoints()).linear().col(2);
    plane_W = PoseAt(StartJoints()).translation() + 0.005 * feed_W;
  }

  TickRecord Run(int count) {
    TickRecord record;
    for (int i = 0; i < count; ++i) {
      now += 4 * rt::kMillisecond;
      if (i > 0 || answered_) arm.q_meas = command.q;
      answered_ = true;
      arm.q_ipo = arm.q_meas;
      arm.has_ipo = true;
      arm.stamp = now;
      ++arm.sequence;
      readings.force = {.stamp = now,
                        .F_S = ServoBench::OnTheSensor({.f = push_W_N, .t = Vector3::Zero()}, ToolNow())};
      ++model.frame;
      model.pose_stamp = now;
      model.contact_count = 1;
      model.contacts[0].p_W_m = plane_W;
      model.contacts[0].n_W = Vector3(-feed_W);
      model.contacts[0].stiffness_N_per_m = kStiffness_N_per_m;
      record = loop.Tick(
          {.state = arm, .received = ReceiveResult::kOk, .readings = readings, .model = model, .now = now},
          command);
    }
    return record;
  }

  [[nodiscard]] Pose ToolNow() const { return PoseAt(Eigen::Map<const Joints>(arm.q_meas.data())); }

  ServoLoop loop;
  ArmState arm;
  ArmCommand command;
  CellReadings readings;
  simulation::ContactModel model;
  rt::Nanoseconds now{rt::kSecond};
  Vector3 push_W_N{Vector3::Zero()}, feed_W, plane_W;

 private:
  bool answered_{false};
};

TEST(ServoSixAxis, AHandComesToRestInTheWallAtForceOverStiffness) {
  SixAxisBench bench;
  const Matrix3 R_start = bench.ToolNow().linear();
  bench.push_W_N = 60.0 * bench.feed_W;
  const TickRecord record = bench.Run(1500);
  EXPECT_FALSE(bench.loop.faults().Any()) << bench.loop.faults().bits();
  EXPECT_EQ(record.phase, Phase::kHaptic);
  const double dead_zone_N = Params().admittance.dead_zone_N;
  const double depth_m = bench.feed_W.dot(bench.ToolNow().translation() - bench.plane_W);
  EXPECT_NEAR(depth_m, (60.0 - dead_zone_N) / kStiffness_N_per_m, 1e-6);
  EXPECT_NEAR(Vector3(record.F_coupling_T_W.f).norm(), 60.0 - dead_zone_N, 0.01);
  EXPECT_LT((bench.ToolNow().linear() - R_start).norm(), 1e-6) << "nothing turns it";
  EXPECT_EQ(bench.command.q[6], 0.0);
}

TEST(ServoSixAxis, InFreeAirTheToolMovesAtForceOverDamping) {
  SixAxisBench bench;
  const Vector3 along_W = bench.feed_W.unitOrthogonal();
  bench.push_W_N = 10.0 * along_W;
  const TickRecord record = bench.Run(100);
  const double expected = (10.0 - Params().admittance.dead_zone_N) / 120.0;
  EXPECT_NEAR(Vector3(record.v_WT_cmd_m_per_s).dot(along_W), expected, 0.01 * expected);
  EXPECT_FALSE(bench.loop.faults().Any());
}

TEST(ServoSixAxis, MovesToItsStartAndRendersThere) {
  ServoParams params = Params();
  params.start.emplace();
  params.start->q.head<6>() = StartJoints();
  Joints q = StartJoints();
  q += Joints::Constant(0.1);
  SixAxisBench bench(params, q);
  EXPECT_EQ(bench.Run(50).phase, Phase::kAligning);
  EXPECT_EQ(bench.Run(2000).phase, Phase::kHaptic);
  EXPECT_LT((Eigen::Map<const Joints>(bench.arm.q_meas.data()) - StartJoints()).norm(), 1e-3);
  EXPECT_FALSE(bench.loop.faults().Any());
}

TEST(ServoSixAxis, AJointLimitHoldsTheToolWithoutAFault) {
  ServoParams params = Params();
  params.joints.limits[0].upper_rad = StartJoints()[0] + 0.05;
  SixAxisBench bench(params);
  // KUKA's axis A1 turns clockwise about z, so its angle grows as the tool moves toward -y
  bench.push_W_N = 30.0 * Vector3(0.0, -1.0, 0.0);
  const TickRecord record = bench.Run(1500);
  EXPECT_EQ(record.phase, Phase::kHaptic);
  EXPECT_FALSE(bench.loop.faults().Any()) << bench.loop.faults().bits();
  EXPECT_LE(record.q_cmd[0], params.joints.limits[0].upper_rad);
  EXPECT_GT(bench.loop.statistics().limits.Of(safety::Limit::kJoints).ticks, 100u);
}

TEST(ServoSixAxis, StopsToRestAndDoesNotAllocate) {
  SixAxisBench bench;
  bench.push_W_N = 20.0 * bench.feed_W.unitOrthogonal();
  bench.Run(20);
  {
    rt::CheckedNoAllocScope no_alloc;
    bench.Run(20);
    bench.loop.RequestStop();
    bench.Run(200);
  }
  EXPECT_EQ(bench.loop.phase(), Phase::kStopped);
  EXPECT_FALSE(bench.loop.faults().Any());
}

TEST(ServoSixAxis, RefusesATransformThatIsNoRigidMotion) {
  Pose X_FT = Pose::Identity();
  X_FT.linear() *= 2.0;
  EXPECT_THROW(ServoLoop(Params(), Arm(), Pose::Identity(), X_FT), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::control
