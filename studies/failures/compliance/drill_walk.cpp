#include "studies/failures/compliance/drill_walk.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "control/compliance/compliance.h"
#include "control/coupling/virtual_coupling.h"
#include "simulation/tools/tool_compliance.h"
#include "simulation/tools/tool_kinds.h"
#include "studies/failures/compliance/law_trial.h"
#include "studies/failures/contact_bench.h"
#include "studies/failures/scenario_bench.h"

namespace osteon::studies {
namespace {

constexpr double kTick_s = 1e-3, kPush_N = 60.0, kPushRise_s = 0.5, kTilt_rad = std::numbers::pi / 9.0;
constexpr double kSpindle_rad_per_s = 104.7;  // 1000 rpm
constexpr int kFine = 5;                      // ticks per millisecond in the reference run
constexpr double kSeen_s = 1.5;               // time at which the hole's place is measured
constexpr double kCutting_J_per_m3 = 1.3e9;   // human femoral cortex (config/materials)

constexpr double kAbove_m = 0.2e-3;  // distance along the axis between the apex and the place it is aimed at
// Stiffnesses of the coupling: a pressed drill is ahead of its proxy by the push divided by this stiffness.
// The impedance law's overlay allows less stiffness.
constexpr double kAdmittance_N_per_m = 60e3, kImpedance_N_per_m = 10e3;

// How the drill's bending is computed: in equilibrium with each frame's planes (a baseline), or by
// control::Compliance, whose bend follows the force with the lag ToolLinkParams::tau_s.
enum class Bending : std::uint8_t { kSolvedWithPlanes, kElement };

// Bone, drill and its bending, and the parameters of the cut.
struct Scene {
  simulation::Bone bone;
  simulation::Tool tool;
  control::ToolLinkParams link;
  simulation::CuttingParams cutting;
};

// @param full  the bone has finer balls
// @param stiffness_N_per_m  of the coupling
Scene MakeScene(bool full, double stiffness_N_per_m) {
  const simulation::BuiltTool drill = simulation::MakeTwistDrill({});
  const simulation::ToolCompliance bends =
      simulation::CantileverCompliance(drill.beam, {.load_point_m = drill.load_point_m});
  Scene scene{.bone = MakeBlock({.low_m = {-3e-3, -3e-3, -3e-3},
                                 .high_m = {4e-3, 3e-3, 0.0},
                                 .ball_radius_m = full ? 0.25e-3 : 0.4e-3,
                                 .point_spacing_m = 0.25e-3,
                                 .specific_cutting_energy_J_per_m3 = kCutting_J_per_m3}),
              .tool = drill.tool,
              .link = {.compliance_T = bends.C_T * simulation::ThrustFactor(kPush_N, bends.buckling_N),
                       .tau_s = 0.020},
              .cutting = {}};
  scene.cutting.stiffness_N_per_m = stiffness_N_per_m;
  scene.cutting.normal_enlargement_m = 0.1e-3;
  scene.cutting.max_slide_m = 0.4e-3;
  scene.cutting.engaged_layer_m = 0.25e-3;
  return scene;
}

// The result of drilling one hole.
struct HoleResult {
  double aside_m{0.0};  ///< distance of the head from the axis that it was aimed along, at kSeen_s
  bool fault{false};
  std::vector<Pose> handle{};  ///< pose that the tool would have without its bend, each millisecond
  FailureSeries series;
};

// The bone's frame: its surface is tilted, and lies a little below the drill's apex.
Pose BoneUnderDrill() {
  const Vector3 turn(0.0, kTilt_rad, 0.0);
  const Vector3 feed_G = Down(Vector3::Zero(), turn).linear() * Vector3::UnitZ();
  return StartOfLawTrial() * Down(-kAbove_m * feed_G, turn).inverse();
}

// Finds the head's pose at which the drill's bending is in equilibrium with the force of the frame's planes.
// Takes 60 steps, each of 15 % of the remaining difference.
Pose SolvedHead(const Scene& scene, const control::CouplingParams& coupling,
                const simulation::ContactModel& model, const Pose& X_WT, rt::Nanoseconds now,
                const control::CouplingState& state) {
  control::Vector6 e = control::Vector6::Zero();  // displacement and rotation of the head, in T
  for (int i = 0; i < 60; ++i) {
    control::CouplingState trial = state;
    const Pose X_WE = X_WT * control::BentHead(e);
    const Wrench F = control::EvaluateCoupling(
                         coupling, {.model = model, .X_WT = X_WE, .now = now, .spindle_turns = true}, trial)
                         .F_contact_T_W;
    control::Vector6 F_T;
    F_T << X_WT.linear().transpose() * F.f, X_WT.linear().transpose() * F.t;
    e += 0.15 * (scene.link.compliance_T * F_T - e);
  }
  return X_WT * control::BentHead(e);
}

// Drills again with a recorded path of the handle, without the servo loop: with a shorter period, or with
// another computation of the bending. @param ticks_in_ms  number of ticks and frames per millisecond
HoleResult DrillAlong(const FailureSetting& setting, const Scene& scene, const std::vector<Pose>& handle,
                      Bending bending, int ticks_in_ms) {
  const double dt_s = kTick_s / ticks_in_ms;
  const Pose X_start = StartOfLawTrial();
  const Vector3 feed_W = X_start.linear().col(2);
  const auto engine = setting.make_engine(scene.bone, scene.tool, BoneUnderDrill(), scene.cutting);
  control::ComplianceParams parts;
  if (bending == Bending::kElement) parts.tool = scene.link;
  control::Compliance compliance(parts, dt_s);
  control::CouplingParams coupling;
  coupling.max_stiffness_N_per_m = scene.cutting.stiffness_N_per_m;
  coupling.damping_Ns_per_m = 0.0;  // the lag of the drill's bending dissipates energy instead
  control::CouplingState state;
  state.fade = 1.0;
  HoleResult hole_result;
  simulation::ContactModel model;
  const int ticks = ticks_in_ms * (static_cast<int>(handle.size()) - 1);
  for (int i = 0; i < ticks; ++i) {
    const auto now = static_cast<rt::Nanoseconds>(std::llround(1e9 * dt_s * (i + 1)));
    const auto ms = static_cast<std::size_t>(i / ticks_in_ms);
    const double share = static_cast<double>(i % ticks_in_ms) / ticks_in_ms;
    Pose X_WT = handle[ms];
    X_WT.translation() += share * (handle[ms + 1].translation() - handle[ms].translation());
    const Pose X_ME = bending == Bending::kSolvedWithPlanes
                          ? SolvedHead(scene, coupling, model, X_WT, now, state)
                          : compliance.X_ME(X_WT);
    model = engine->Step(FrameAt(X_ME, kSpindle_rad_per_s, dt_s));
    model.pose_stamp = now;
    const control::CouplingOutput out = control::EvaluateCoupling(
        coupling, {.model = model, .X_WT = X_ME, .now = now, .spindle_turns = true}, state);
    compliance.Step(out.F_contact_T_W, model, X_WT);
    const Vector3 from_start = X_ME.translation() - X_start.translation();
    hole_result.aside_m = (from_start - from_start.dot(feed_W) * feed_W).norm();
    if (i % (5 * ticks_in_ms) == 0) {
      hole_result.series.x.push_back(dt_s * i);
      hole_result.series.y.push_back(1e3 * hole_result.aside_m);
    }
  }
  return hole_result;
}

// Drills through the servo loop with the admittance law or the impedance law. The drill's handle is guided:
// under the admittance law by the locked axes of the virtual tool, under the impedance law by a jig that
// holds the tool across its axis.
HoleResult DrillByLaw(const FailureSetting& setting, const Scene& scene, control::Law law, bool bends) {
  const Pose X_start = StartOfLawTrial();
  const auto engine = setting.make_engine(scene.bone, scene.tool, BoneUnderDrill(), scene.cutting);
  LawTrialParams params{.loop = LoopOfLaw(law, scene.cutting.stiffness_N_per_m), .seconds = kSeen_s};
  if (bends) params.loop.compliance.tool = scene.link;
  params.loop.spindle_rad_per_s = kSpindle_rad_per_s;
  params.loop.coupling.damping_Ns_per_m = 0.0;  // as in DrillAlong
  params.loop.admittance.damping_Ns_per_m.setConstant(150.0);
  params.loop.admittance.locked = {true, true, false, true, true, true};
  const Vector3 feed_W = X_start.linear().col(2);
  HoleResult hole_result;
  const LawScene trial{
      .hand =
          [&](int tick, const Pose& X_WT, const Twist& V_WT) {
            constexpr double kJig_N_per_m = 100e3, kJig_Ns_per_m = 800.0;  // a bench's holder, assumed
            constexpr double kJig_Nm_per_rad = 400.0, kJig_Nms_per_rad = 1.0;
            Wrench F_T_W;
            if (law == control::Law::kImpedance) {
              const Vector3 from_start = X_WT.translation() - X_start.translation();
              const Eigen::AngleAxisd turned(X_WT.linear() * X_start.linear().transpose());
              const Matrix3 across = Matrix3::Identity() - feed_W * feed_W.transpose();
              F_T_W.f = -across * (kJig_N_per_m * from_start + kJig_Ns_per_m * V_WT.v);
              F_T_W.t = -kJig_Nm_per_rad * turned.angle() * turned.axis() - kJig_Nms_per_rad * V_WT.w;
            }
            F_T_W.f += RisingPush(kPush_N, kTick_s * tick, kPushRise_s) * feed_W;
            return F_T_W;
          },
      .bone =
          [&](const simulation::ToolCommand& command) {
            return engine->Step(FrameAt(Pose(command.X_WT), command.spindle_rad_per_s, kTick_s));
          },
      // records how far aside the head is, and the tool's pose without its bend
      .seen =
          [&](int tick, const LawTrialTick& state) {
            const Vector3 from_start = state.X_ME.translation() - X_start.translation();
            hole_result.aside_m = (from_start - from_start.dot(feed_W) * feed_W).norm();
            hole_result.handle.push_back(state.X_WT_sim);
            if (tick % 5 == 0) {
              hole_result.series.x.push_back(kTick_s * tick);
              hole_result.series.y.push_back(1e3 * hole_result.aside_m);
            }
            return true;
          }};
  hole_result.fault = RunLawTrial(params, trial).Any();
  return hole_result;
}

}  // namespace

FailureResult RunDrillWalk(const FailureSetting& setting) {
  FailureResult result{.id = 40,
                       .name = "drill walks",
                       .metric = "error of the hole's place",
                       .unit = "mm",
                       .baseline_name = "a rigid drill",
                       .bound = 0.1};
  bool complete = true, fault = false, all_fail = true;
  double solved_mm = 0.0, truth_mm = 0.0;
  for (const control::Law law : {control::Law::kImpedance, control::Law::kAdmittance}) {
    const bool is_admittance = law == control::Law::kAdmittance;
    const Scene scene = MakeScene(setting.full(), is_admittance ? kAdmittance_N_per_m : kImpedance_N_per_m);
    HoleResult rigid = DrillByLaw(setting, scene, law, false), ours = DrillByLaw(setting, scene, law, true);
    HoleResult truth = DrillAlong(setting, scene, ours.handle, Bending::kElement, kFine);
    complete = complete && setting.GoesOn(is_admittance ? 0.6 : 0.3);
    const double rigid_mm = 1e3 * std::abs(rigid.aside_m - truth.aside_m);
    all_fail = all_fail && rigid_mm > 3.0 * result.bound;
    fault = fault || ours.fault;
    result.baseline = std::max(result.baseline, rigid_mm);
    result.ours = std::max(result.ours, 1e3 * std::abs(ours.aside_m - truth.aside_m));
    if (!is_admittance) continue;
    HoleResult solved = DrillAlong(setting, scene, ours.handle, Bending::kSolvedWithPlanes, 1);
    truth_mm = 1e3 * truth.aside_m;
    solved_mm = 1e3 * std::abs(solved.aside_m - truth.aside_m);
    rigid.series.name = "rigid";
    solved.series.name = "solved with the planes";
    truth.series.name = "a fifth of the period";
    ours.series.name = "ours";
    ours.series.ours = true;
    result.plot = {.x_label = "time [s]",
                   .y_label = "head beside its axis [mm]",
                   .series = {rigid.series, solved.series, truth.series, ours.series}};
  }
  result.baseline_fails = all_fail && solved_mm > 3.0 * result.bound;
  result.ours_passes = complete && !fault && result.ours <= result.bound;
  result.note = fmt::format(
      "the bent drill begins its hole {:.2f} mm aside; where the bending is solved with each frame's planes, "
      "its error is {:.2f} mm; both laws through the servo loop{}",
      truth_mm, solved_mm, fault ? "; a fault ended a trial" : "");
  return result;
}

}  // namespace osteon::studies
