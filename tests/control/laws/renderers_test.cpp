#include <gtest/gtest.h>

#include "control/laws/admittance_renderer.h"
#include "control/laws/impedance_renderer.h"
#include "tests/control/loop/servo_parts.h"

// Tests the two renderers. One carries out a tick of the admittance law, the other a tick of the impedance
// law.

namespace osteon::control {
namespace {

using safety::Limit, safety::LimitSet;

// Both renderers, with the parts of the loop that they use. In a tick the tool is `depth_m` deep in bone; a
// negative depth is above the bone.
struct Bench {
  explicit Bench(const ServoParams& p)
      : params(p),
        tool(params, Follower(params)),
        coupling(params),
        session(params),
        admittance(params),
        impedance(params) {
    coupling.Reset();
    admittance.Reset(tool.X_WT());
    impedance.Reset(state.q_meas);
  }
  // Evaluates the coupling at this pose.
  void EvaluateCoupling(double depth_m, const Pose& X_WT, const Twist& V_WT) {
    const simulation::ContactModel model = PlaneBehind(depth_m, now);
    static_cast<void>(
        coupling.Evaluate({.model = model, .X_WT = X_WT, .V_WT = V_WT, .now = now, .spindle_turns = false},
                          tool.arm(), acting));
  }
  // A tick under the admittance law; the hand pushes along the feed.
  AdmittanceStep TickAdmittance(double push_N, double depth_m, double sensor_fade = 1.0) {
    now += rt::kMillisecond;
    EvaluateCoupling(depth_m, tool.X_WT(), tool.Velocity());
    const Vector3 feed_W = ServoBench::StartPose().linear().col(2);
    return admittance.Step({.F_hand_T_W = {.f = push_N * feed_W, .t = Vector3::Zero()},
                            .sensor_fade = sensor_fade,
                            .max_hand_N = 250.0},
                           coupling, tool);
  }
  // A tick under the impedance law, with an arm that stands still.
  ImpedanceStep TickImpedance(double depth_m) {
    now += rt::kMillisecond;
    session.OnMessage(state, ServoBench::StartPose(), now);
    const Twist V_before = tool.V_WT;
    tool.V_WT = session.V_WT();
    tool.fade = 1.0;
    EvaluateCoupling(depth_m, session.X_WT(), tool.V_WT);
    motion = impedance.FollowHand(session, state.q_meas, false, tool);
    return impedance.Step(session, V_before, motion, coupling, tool);
  }

  ServoParams params;
  ArmState state{StandingArm()};
  CommandedTool tool;
  CouplingPipeline coupling;
  ArmSession session;
  AdmittanceRenderer admittance;
  ImpedanceRenderer impedance;
  ImpedanceMotion motion;
  LimitSet acting;
  rt::Nanoseconds now{rt::kSecond};
};

TEST(AdmittanceRenderer, AHandMovesAFreeToolAtForceOverDamping) {
  Bench bench(ServoBench::Params());
  const Vector3 p_before = bench.tool.X_WT().translation();
  AdmittanceStep step;
  for (int i = 0; i < 1200; ++i) step = bench.TickAdmittance(1.0, -10.0);
  EXPECT_TRUE(step.finite);
  EXPECT_EQ(step.fault, safety::Fault::kNone);
  const Vector3 feed_W = ServoBench::StartPose().linear().col(2);
  const Wrench F_hand = SubtractDeadZone(bench.params.admittance, {.f = 1.0 * feed_W, .t = Vector3::Zero()});
  const double drag = bench.params.admittance.damping_Ns_per_m.z();
  EXPECT_NEAR(bench.tool.V_WT.v.dot(feed_W), F_hand.f.norm() / drag, 0.02 * F_hand.f.norm() / drag);
  EXPECT_GT((bench.tool.X_WT().translation() - p_before).dot(feed_W), 0.0);
}

TEST(AdmittanceRenderer, AHandsForceThatIsTooOldDoesNotPush) {
  Bench bench(ServoBench::Params());
  AdmittanceStep step;
  for (int i = 0; i < 300; ++i) step = bench.TickAdmittance(10.0, -10.0, 0.0);
  EXPECT_EQ(bench.tool.V_WT.v, Vector3::Zero());
  EXPECT_TRUE(step.acting.Has(Limit::kSensorAge));
}

TEST(AdmittanceRenderer, KeepsTheToolInsideTheWorkspaceAndReportsTheLimit) {
  ServoParams params = ServoBench::Params();
  params.workspace.sphere_radius_m = 0.01;
  params.workspace.sphere_center_W_m = ServoBench::StartPose().translation();
  Bench bench(params);
  LimitSet acting;
  for (int i = 0; i < 3000; ++i) acting.Add(bench.TickAdmittance(30.0, -10.0).acting);
  EXPECT_TRUE(acting.Has(Limit::kWorkspace));
  const Vector3 p = bench.tool.X_WT().translation();
  EXPECT_LE((p - ServoBench::StartPose().translation()).norm(), 0.01 + 1e-6);
}

TEST(ImpedanceRenderer, OverlaysTheCouplingsWrenchOnlyInWrenchMode) {
  ServoParams params = ServoBench::Params();
  params.law = Law::kImpedance;
  Bench bench(params);
  ImpedanceStep step;
  for (int i = 0; i < 500; ++i) step = bench.TickImpedance(2e-3);
  EXPECT_FALSE(bench.motion.faults.Any());
  EXPECT_GT(step.rendered.F.f.norm(), 30.0);
  ArmCommand command;
  bench.state.command_mode = CommandMode::kWrench;
  bench.impedance.FillWrenchOverlay(bench.state, bench.session.X_WT(), bench.tool.arm(), command);
  const Vector3 sent_W = bench.session.X_WT().linear() * Vector3(command.F.f);
  EXPECT_NEAR((sent_W - step.rendered.F.f).norm(), 0.0, 1e-9) << "it stands: nothing is damped";
  bench.state.command_mode = CommandMode::kPosition;
  bench.impedance.FillWrenchOverlay(bench.state, bench.session.X_WT(), bench.tool.arm(), command);
  EXPECT_EQ(Vector3(command.F.f), Vector3::Zero()) << "an arm in position mode takes no overlay";
  bench.impedance.ClearWrench();
  bench.state.command_mode = CommandMode::kWrench;
  bench.impedance.FillWrenchOverlay(bench.state, bench.session.X_WT(), bench.tool.arm(), command);
  EXPECT_EQ(Vector3(command.F.f), Vector3::Zero()) << "a wrench counts for its own tick";
}

TEST(ImpedanceRenderer, AStopEndsOnceTheArmIsSeenToStand) {
  ServoParams params = ServoBench::Params();
  params.law = Law::kImpedance;
  Bench bench(params);
  bench.TickImpedance(-10.0);
  bench.impedance.StartBraking();
  int ticks = 1;
  while (!bench.impedance.Brake(bench.session, bench.coupling.limiter(), bench.tool) && ticks < 1000) ++ticks;
  EXPECT_EQ(ticks, JointStopTicks(params) + ArmSession::kStandingMessages);
}

}  // namespace
}  // namespace osteon::control
