#include "simulation/engine/frame_solution.h"

#include <cmath>
#include <limits>
#include <random>
#include <set>

#include <gtest/gtest.h>

// Tests of the parts of a frame that all engines share: the tool's placement, the advance by the rate law,
// the finished model, and frames in parts.

namespace osteon::simulation {
namespace {

constexpr double kSpindle = 250.0 * 2.0 * M_PI / 60.0;  // 250 rpm in rad/s

// ---- placing the tool

TEST(PlaceTool, TransformsTheBallCentresAndThenTheOriginToG) {
  const Tool tool = MakeReamer(0.025, 0.008, 0.016, 0.9, Vector3::Zero());
  Pose X = Pose::Identity();
  X.linear() = ExpRotation({M_PI, 0, 0});  // feed down
  X.translation() = Vector3(0.1, 0.2, 0.3);
  const ToolPoints points = PlaceTool(tool, X);
  ASSERT_EQ(points.size(), tool.balls.size() + 1);
  EXPECT_LT((points[0] - Vector3(0.1, 0.2, 0.325)).norm(), 1e-15);
  EXPECT_EQ(points.back(), Vector3(0.1, 0.2, 0.3));
  const ToolPoints half = InterpolatePoints(points, PlaceTool(tool, Pose::Identity()), 0.5);
  EXPECT_LT((half[0] - Vector3(0.05, 0.1, 0.15)).norm(), 1e-15);
}

// ---- the end of the advance

TEST(ComputeAdvanceEnd, StopsAtThePlaneOfABallThatDoesNotCut) {
  FrameSolution s;
  s.step = Vector3(0, 0, -0.2e-3);
  EXPECT_LT((ComputeAdvanceEnd(s) - Vector3(0, 0, -0.2e-3)).norm(), 1e-18);
  s.shaft_count = 1;
  s.shaft[0] = {.n = Vector3::UnitZ(), .gap_m = 0.05e-3};
  EXPECT_LT((ComputeAdvanceEnd(s) - Vector3(0, 0, -0.05e-3)).norm(), 1e-18);
  s.shaft[0] = {.n = Vector3::UnitX(), .gap_m = 0.0};  // a wall parallel to the motion does not matter
  EXPECT_LT((ComputeAdvanceEnd(s) - Vector3(0, 0, -0.2e-3)).norm(), 1e-18);
}

TEST(ComputeAdvanceStep, FollowsTheNormalOrWithTheImmediateLawGoesToTheGoal) {
  FrameSolution s;
  s.n = Vector3::UnitZ();
  s.advance_m = 0.2e-3;
  s.delta = Vector3(0.1e-3, 0, 0.3e-3);
  s.origin_slid = Vector3(1e-3, 0, 0);
  const Vector3 goal(4e-3, 0, -0.3e-3);
  const FrameInput cuts{.X_WT = Pose::Identity(), .spindle_rad_per_s = kSpindle}, still{};
  const CuttingParams immediate{.law = RemovalLaw::kImmediate};
  EXPECT_EQ(ComputeAdvanceStep({}, cuts, s, goal), Vector3(0, 0, -0.2e-3));
  s.step = ComputeAdvanceStep(immediate, cuts, s, goal);
  EXPECT_LT((ComputeAdvanceEnd(s) - goal).norm(), 1e-18);
  s.shaft_count = 1;
  s.shaft[0] = {.n = -Vector3::UnitX(), .gap_m = 2e-3};  // gap at first contact; the slide used 1 mm of it
  EXPECT_LT((ComputeAdvanceEnd(s) - Vector3(2e-3, 0, -0.3e-3)).norm(), 1e-18);

  s.advance_m = 0.0;
  EXPECT_EQ(ComputeAdvanceStep(immediate, still, s, goal).norm(), 0.0);
  // there is contact but no advance, because a ball that does not cut stops the tool
  EXPECT_EQ(ComputeAdvanceStep(immediate, cuts, s, goal).norm(), 0.0);
  s.delta.setZero();  // nothing holds the tool
  EXPECT_EQ(ComputeAdvanceStep(immediate, cuts, s, goal), goal - s.origin_slid);
  EXPECT_EQ(ComputeAdvanceStep({}, cuts, s, goal).norm(), 0.0);
}

// ---- the rate law

// A cut pressed 2 mm deep, 40 N, with 500 mm^2 of engaged area at a mean arm of 15 mm.
struct Cut {
  CuttingParams params;
  std::vector<Material> materials{{.name = "bone", .specific_cutting_energy_J_per_m3 = 50e6}};
  FrameSolution solution;
  Cut() {
    solution.n = Vector3::UnitZ();
    solution.cutting_m = 2e-3;
    solution.engaged_area_m2[0] = 500e-6;
    solution.engaged_moment_m3[0] = 500e-6 * 15e-3;
  }
  FrameAdvance Advance(double dt_s, double spindle = kSpindle, double energy_lead_J = 0.0) const {
    return ComputeAdvance(params, materials, solution, spindle, dt_s, energy_lead_J);
  }
};

TEST(ComputeAdvance, IsTheExactSolutionOfTheRateLaw) {
  const Cut cut;
  // x' = -c K x with c = mu_c r_eff w / (u_c A)
  const double c = 0.8 * 15e-3 * kSpindle / (50e6 * 500e-6);
  for (const double dt : {1e-5, 1e-3, 4e-3}) {
    const double expected = 2e-3 * (1.0 - std::exp(-c * 20e3 * dt));
    EXPECT_NEAR(cut.Advance(dt).advance_m, expected, 1e-9 * expected) << dt;
  }
}

TEST(ComputeAdvance, TwoHalfStepsEqualOneStep) {
  for (const double dt : {1e-4, 1e-3, 10e-3}) {
    Cut cut;
    cut.params.max_slide_m = 1.0;  // the limit on a frame's travel is not part of the law
    const double whole = cut.Advance(dt).advance_m;
    const double first = cut.Advance(0.5 * dt).advance_m;
    cut.solution.cutting_m -= first;
    const double second = cut.Advance(0.5 * dt).advance_m;
    EXPECT_NEAR(first + second, whole, 1e-9 * whole) << dt;
  }
}

TEST(ComputeAdvance, NeverExceedsThePenetration) {
  Cut cut;
  cut.params.max_slide_m = 1.0;
  cut.materials[0].specific_cutting_energy_J_per_m3 = 1.0;  // almost no resistance
  EXPECT_LE(cut.Advance(1.0).advance_m, cut.solution.cutting_m);
  cut.solution.engaged_area_m2[0] = 0.0;  // nothing with mass is engaged, so nothing stops the tool
  EXPECT_EQ(cut.Advance(1.0).advance_m, cut.solution.cutting_m);
}

TEST(ComputeAdvance, IsLimitedToTheLargestSlideOfAFrame) {
  Cut cut;
  cut.materials[0].specific_cutting_energy_J_per_m3 = 1.0;
  EXPECT_EQ(cut.Advance(1.0).advance_m, cut.params.max_slide_m);
}

TEST(ComputeAdvance, IsZeroForAStillSpindleOrNoTime) {
  Cut cut;
  for (const RemovalLaw law : {RemovalLaw::kRate, RemovalLaw::kImmediate}) {
    cut.params.law = law;
    EXPECT_EQ(cut.Advance(1e-3, 0.0).advance_m, 0.0);
    EXPECT_EQ(cut.Advance(1e-3, 0.0).edge_work_J, 0.0);
    EXPECT_EQ(cut.Advance(0.0).advance_m, 0.0);
  }
}

TEST(ComputeAdvance, DoesNotDependOnTheSpindlesDirection) {
  const Cut cut;
  EXPECT_EQ(cut.Advance(1e-3, kSpindle).advance_m, cut.Advance(1e-3, -kSpindle).advance_m);
}

TEST(ComputeAdvance, WithTheImmediateLawIsTheWholePenetration) {
  Cut cut;
  cut.params.law = RemovalLaw::kImmediate;
  EXPECT_EQ(cut.Advance(1e-3).advance_m, cut.solution.cutting_m);
}

TEST(ComputeAdvance, DoesNotGrowBeyondTheLargestForce) {
  Cut cut;
  cut.materials[0].specific_cutting_energy_J_per_m3 = 1e12;  // so hard that the advance is linear in time
  cut.solution.cutting_m = 10e-3;                            // pressed to the force limit of 200 N
  const double at_limit = cut.Advance(1e-3).advance_m;
  cut.solution.cutting_m = 20e-3;
  EXPECT_NEAR(cut.Advance(1e-3).advance_m, at_limit, 1e-6 * at_limit);
}

TEST(ComputeAdvance, EdgeWorkIsTheCuttingEnergyOfTheSweptVolume) {
  const Cut cut;
  const FrameAdvance frame = cut.Advance(1e-3);
  EXPECT_NEAR(frame.edge_work_J, 50e6 * 500e-6 * frame.advance_m, 1e-12);
}

// energy_lead_J is the energy of bone that was cleared before the edge had done this work. A frame's work
// first reduces this lead.
TEST(ComputeAdvance, RecoversTheEnergyLeadBeforeItAdvances) {
  const Cut cut;
  const double dt = 1e-3, work_J = 40.0 * 0.8 * 15e-3 * kSpindle * dt;
  const double free_m = cut.Advance(dt).advance_m;
  // a lead so large that its reduction takes half of the frame's work
  const double energy_lead_J = 0.5 * work_J * kEnergyLeadSeconds / dt;
  const FrameAdvance paying = cut.Advance(dt, kSpindle, energy_lead_J);
  EXPECT_NEAR(paying.advance_m, 0.5 * free_m, 1e-2 * free_m);  // 1 %: the law's curvature over the frame
  // the edge has done the same work as without a lead, to the same accuracy
  EXPECT_NEAR(paying.edge_work_J, work_J, 1e-2 * work_J);
  // a lead beyond the frame's work stops the advance, while the edge still works
  const FrameAdvance held = cut.Advance(dt, kSpindle, 10.0 * energy_lead_J);
  EXPECT_EQ(held.advance_m, 0.0);
  EXPECT_NEAR(held.edge_work_J, work_J, 1e-12);
}

TEST(ComputeAdvance, EdgePowerIsTheCuttingForceTimesArmAndSpeed) {
  const Cut cut;
  const double dt = 1e-9;  // so short that the force does not fall
  EXPECT_NEAR(cut.Advance(dt).edge_work_J / (kSpindle * dt), 0.8 * 40.0 * 15e-3, 1e-6);
}

// ---- the finished frame

// A contact with normal n and point p_T_m that holds the tool by multiplier_m.
SolvedContact At(const Vector3& n, const Vector3& p_T_m, double multiplier_m, double weight = 1.0) {
  return {.n = n, .p_T_m = p_T_m, .gap_m = -multiplier_m, .multiplier_m = multiplier_m, .weight = weight};
}

// A frame of one material with the tool at the origin, to which contacts are added before it is finished.
struct Frame {
  CuttingParams params;
  std::vector<Material> materials{{.name = "bone", .specific_cutting_energy_J_per_m3 = 50e6}};
  MaterialMap map{Bone{}};
  FrameInput input;
  FrameSolution solution;
  FrameMemory memory;
  void Add(const SolvedContact& contact) {
    solution.contacts[static_cast<std::size_t>(solution.contact_count++)] = contact;
  }
  ContactModel Finish(const Pose& X_WG = Pose::Identity()) {
    return FinishFrame(params, materials, map, X_WG, input, solution, memory);
  }
};

TEST(FinishFrame, GivesAForceAlongTheNormalOfStiffnessTimesDepth) {
  Frame frame;
  frame.Add(At(Vector3::UnitZ(), Vector3::Zero(), 3e-3));
  const ContactModel model = frame.Finish();
  EXPECT_EQ(model.contact_count, 1);
  EXPECT_LT((Vector3(model.F_T_W.f) - Vector3(0, 0, 60.0)).norm(), 1e-12);
}

TEST(FinishFrame, LimitsTheWrenchWithoutChangingItsDirection) {
  Frame frame;
  frame.Add(At(Vector3::UnitZ(), Vector3(5e-3, 0, 0), 3e-3));
  frame.Add(At(Vector3::UnitX(), Vector3(0, 20e-3, 0), 4e-3));
  SolvedContact &floor = frame.solution.contacts[0], &wall = frame.solution.contacts[1];
  const Wrench free = frame.Finish().F_T_W;
  EXPECT_LT((free.f - Vector3(80, 0, 60)).norm(), 1e-10);
  floor.multiplier_m *= 5.0;
  wall.multiplier_m *= 5.0;
  const Wrench limited = frame.Finish().F_T_W;
  EXPECT_NEAR(limited.f.norm(), 200.0, 1e-10);
  EXPECT_LT((limited.f - 2.0 * free.f).norm(), 1e-10);
  EXPECT_LT((limited.t - 2.0 * free.t).norm(), 1e-12);
}

TEST(FinishFrame, TorqueIsThatOfTheContactForceAboutTheToolsOrigin) {
  Frame frame;
  Pose X_WT = Pose::Identity();
  X_WT.translation() = Vector3(0.3, -0.2, 0.5);
  frame.input.X_WT = X_WT;
  frame.memory.X_GP = X_WT;
  frame.solution.origin_contact = frame.solution.origin_slid = frame.solution.origin_end = X_WT.translation();
  frame.Add(At(Vector3::UnitZ(), Vector3(10e-3, 4e-3, 0), 1e-3));
  const ContactModel model = frame.Finish();
  EXPECT_LT((Vector3(model.contacts[0].p_TP_m) - Vector3(10e-3, 4e-3, 0)).norm(), 1e-15);
  EXPECT_LT((Vector3(model.F_T_W.t) - Vector3(10e-3, 4e-3, 0).cross(Vector3(0, 0, 20))).norm(), 1e-12);
}

TEST(FinishFrame, TransformsForcesNormalsAndPosesFromGToW) {
  Frame frame;
  frame.Add(At(Vector3::UnitZ(), Vector3::Zero(), 1e-3));
  frame.solution.n = Vector3::UnitZ();
  Pose X_WG = Pose::Identity();
  X_WG.linear() = ExpRotation({0, 0.5 * M_PI, 0});  // z of G is x of W
  X_WG.translation() = Vector3(1, 2, 3);
  frame.input.X_WT = X_WG;
  const ContactModel model = frame.Finish(X_WG);
  EXPECT_LT((Vector3(model.F_T_W.f) - Vector3(20, 0, 0)).norm(), 1e-12);
  EXPECT_LT((Vector3(model.n_W) - Vector3::UnitX()).norm(), 1e-12);
  EXPECT_LT((Vector3(model.contacts[0].n_W) - Vector3::UnitX()).norm(), 1e-12);
  EXPECT_LT((Pose(model.X_WP).matrix() - X_WG.matrix()).norm(), 1e-12);
}

TEST(FinishFrame, ContactWeightsAreScaledToASumOfOne) {
  Frame frame;
  frame.Add(At(Vector3::UnitZ(), Vector3::Zero(), 1e-3, 3.0));
  frame.Add(At(Vector3::UnitX(), Vector3::Zero(), 1e-3, 1.0));
  const ContactModel model = frame.Finish();
  ASSERT_EQ(model.contact_count, 2);
  EXPECT_DOUBLE_EQ(model.contacts[0].weight, 0.75);
  EXPECT_DOUBLE_EQ(model.contacts[1].weight, 0.25);
}

// First material at x < 0, second material at x > 0.
Bone HalfAndHalf() {
  Bone bone;
  bone.materials = {{.name = "left", .friction = 0.1}, {.name = "right", .friction = 0.4}};
  for (const double x : {-5e-3, -1e-3, 1e-3, 5e-3})
    bone.points.push_back({.p_m = Vector3(x, 0, 0),
                           .volume_m3 = 1e-9,
                           .material = static_cast<MaterialIndex>(x < 0.0 ? 0 : 1)});
  return bone;
}

TEST(FinishFrame, AShaftsContactHasTheMaterialOfItsPlace) {
  Frame frame;
  frame.materials = HalfAndHalf().materials;
  frame.map = MaterialMap(HalfAndHalf());
  for (const double x : {-3e-3, 3e-3}) {
    SolvedContact contact = At(Vector3::UnitZ(), Vector3(x, 0, 0), 1e-3);
    contact.cutting = false;
    frame.Add(contact);
  }
  // A cutting contact lies in the second material, but the engaged area is in the first. The second contact
  // has the largest multiplier.
  frame.Add(At(Vector3::UnitX(), Vector3(3e-3, 0, 0), 1e-3));
  frame.solution.contacts[1].multiplier_m = 2e-3;
  frame.solution.engaged_area_m2[0] = 1e-6;
  ContactModel model = frame.Finish();
  EXPECT_EQ(model.contacts[0].material, 0);
  EXPECT_EQ(model.contacts[1].material, 1);
  EXPECT_EQ(model.contacts[1].mu, 0.4);
  EXPECT_EQ(model.contacts[2].material, 0) << "of what is engaged";
  EXPECT_EQ(frame.memory.contact.friction, 0.1) << "by engaged area";
  // if nothing is engaged, a cutting ball's contact has the material at its own place, like the other
  // contacts
  frame.solution.engaged_area_m2[0] = 0.0;
  model = frame.Finish();
  EXPECT_EQ(model.contacts[2].material, 1);
  EXPECT_EQ(frame.memory.contact.friction, 0.4) << "of what holds most";
}

TEST(FinishFrame, LooksUpTheMaterialInTheBonesFrame) {
  Frame frame;
  frame.materials = HalfAndHalf().materials;
  frame.map = MaterialMap(HalfAndHalf());
  SolvedContact contact = At(Vector3::UnitZ(), Vector3(3e-3, 0, 0), 1e-3);
  contact.cutting = false;
  frame.Add(contact);
  Pose X_WG = Pose::Identity();
  X_WG.translation() = Vector3(1, 0, 0);
  frame.input.X_WT = X_WG;
  EXPECT_EQ(frame.Finish(X_WG).contacts[0].material, 1);
}

TEST(FinishFrame, AddsUpVolumeMassWorkAndEnergyLead) {
  Frame frame;
  frame.materials.push_back(
      {.name = "hard", .density_kg_per_m3 = 2000.0, .specific_cutting_energy_J_per_m3 = 1e9});
  frame.solution.removed_m3[0] = 10e-9;
  frame.solution.removed_m3[1] = 1e-9;
  frame.solution.edge_work_J = 0.9;
  ContactModel model = frame.Finish();
  EXPECT_NEAR(model.removed_volume_m3, 11e-9, 1e-20);
  EXPECT_NEAR(model.removed_mass_kg, 10e-9 * 1000 + 1e-9 * 2000, 1e-18);
  EXPECT_NEAR(model.cutting_work_J, 0.5 + 1.0, 1e-12);
  EXPECT_NEAR(frame.memory.energy_lead_J, 1.5 - 0.9, 1e-12);
  model = frame.Finish();
  EXPECT_NEAR(model.removed_volume_m3, 22e-9, 1e-20);
  EXPECT_EQ(model.frame, 2u);
}

// The frame's rotation is 0.4 rad. Half of it happens before contact, and half of the remainder after
// contact: 0.3 rad in all.
TEST(FinishFrame, TurnsTheProxyByItsFractionOfThePath) {
  Frame frame;
  Pose X_WT = Pose::Identity();
  X_WT.linear() = ExpRotation({0, 0, 0.4});
  frame.input.X_WT = X_WT;
  frame.solution.contact_fraction = 0.5;
  frame.solution.turn_fraction = 0.5;
  const Pose X_WP = frame.Finish().X_WP;
  EXPECT_LT((LogRotation(X_WP.linear()) - Vector3(0, 0, 0.3)).norm(), 1e-12);
}

// Over 2000 frames in which bone keeps the tool from turning, rounding must not spoil the proxy's rotation.
TEST(FinishFrame, AProxyThatCannotTurnKeepsItsRotation) {
  std::mt19937 random(1);
  std::normal_distribution<> normal;
  for (int k = 0; k < 50; ++k) {
    Frame frame;
    const Matrix3 before = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                               .normalized()
                               .toRotationMatrix();
    frame.memory.X_GP.linear() = before;
    Pose X_WT = Pose::Identity();
    X_WT.linear() = ExpRotation({0.1, 0.2, 0.0}) * before;
    frame.input.X_WT = X_WT;
    frame.solution.contact_fraction = frame.solution.turn_fraction = 0.0;
    for (int i = 0; i < 2000; ++i) frame.Finish();
    EXPECT_LT((frame.memory.X_GP.linear() - before).cwiseAbs().maxCoeff(), 1e-9) << k;
  }
}

TEST(FinishFrame, SpindleTorqueIsTheEdgesWorkOverItsAngle) {
  Frame frame;
  frame.solution.edge_work_J = 0.05;
  EXPECT_EQ(frame.Finish().spindle_torque_Nm, 0.0);  // a spindle at rest has no torque
  frame.input.spindle_rad_per_s = -kSpindle;
  EXPECT_NEAR(frame.Finish().spindle_torque_Nm, 0.05 / (kSpindle * frame.input.dt_s), 1e-12);
}

TEST(FrameMemory, IsUnchangedAfterStoringItInAState) {
  FrameMemory memory{.contact = {},
                     .has_proxy = true,
                     .removed_volume_m3 = 1,
                     .removed_mass_kg = 2,
                     .cutting_work_J = 3,
                     .energy_lead_J = -4,
                     .frame = 5};
  memory.X_GP.translation() = Vector3(1, 2, 3);
  CarvedState state;
  ToState(memory, state);
  const FrameMemory again = ToMemory(state);
  EXPECT_EQ(again.X_GP.matrix(), memory.X_GP.matrix());
  EXPECT_TRUE(again.has_proxy);
  EXPECT_EQ(again.removed_volume_m3, 1);
  EXPECT_EQ(again.removed_mass_kg, 2);
  EXPECT_EQ(again.cutting_work_J, 3);
  EXPECT_EQ(again.energy_lead_J, -4);
  EXPECT_EQ(again.frame, 5u);
}

// ---- frames in parts

// Steps a frame of four parts; part number `failing` does nothing and returns the status.
ContactModel StepFourParts(int failing, EngineStatus status, FrameMemory& memory) {
  int number = 0;
  return StepInParts({.stamp = 7}, Pose::Identity(), 4, memory, [&](const FrameInput& part) {
    ContactModel model;
    if (number == failing) {
      model.status = status;
      return model;
    }
    model.frame = ++memory.frame;
    model.removed_volume_m3 = ++number;
    model.pose_stamp = part.stamp;
    return model;
  });
}

TEST(StepInParts, ARefusedFirstPartLeavesTheFrameUndone) {
  FrameMemory memory{.frame = 10};
  const ContactModel model = StepFourParts(0, EngineStatus::kOverloaded, memory);
  EXPECT_EQ(model.status, EngineStatus::kOverloaded);
  EXPECT_EQ(model.frame, 0u);
  EXPECT_EQ(memory.frame, 10u);
}

// The cuts of earlier parts remain, so the frame must not be reported as refused, which means "unchanged
// bone".
TEST(StepInParts, ARefusedLaterPartEndsTheFrameWithTheEarlierParts) {
  FrameMemory memory{.frame = 10};
  const ContactModel model = StepFourParts(2, EngineStatus::kOverloaded, memory);
  EXPECT_EQ(model.status, EngineStatus::kOk);
  EXPECT_EQ(model.removed_volume_m3, 2.0);
  EXPECT_EQ(model.frame, 11u);
  EXPECT_EQ(memory.frame, 11u);
}

TEST(StepInParts, ReportsALostDeviceEvenAfterCompletedParts) {
  FrameMemory memory{.frame = 10};
  EXPECT_EQ(StepFourParts(2, EngineStatus::kDeviceLost, memory).status, EngineStatus::kDeviceLost);
}

TEST(StepInParts, FourPartsCountAsOneFrame) {
  FrameMemory memory{.frame = 10};
  const ContactModel model = StepFourParts(9, EngineStatus::kOk, memory);
  EXPECT_EQ(model.removed_volume_m3, 4.0);
  EXPECT_EQ(model.frame, 11u);
  EXPECT_EQ(memory.frame, 11u);
}

// ---- input

TEST(IsUsable, AcceptsAnyRotationAndUpToOneSecond) {
  FrameInput input;
  EXPECT_TRUE(IsUsable(input));
  Pose X = Pose::Identity();
  X.linear() = ExpRotation({1.0, -2.0, 0.5});
  input.X_WT = X;
  input.dt_s = 0.0;
  EXPECT_TRUE(IsUsable(input));
  input.dt_s = 1.0;
  input.spindle_rad_per_s = -1e3;
  EXPECT_TRUE(IsUsable(input));
}

TEST(IsUsable, RefusesNonFiniteNumbersNonRotationsAndTimesOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf}) {
    for (std::size_t i = 0; i < 9; ++i) {
      FrameInput input;
      input.X_WT.R[i] = bad;
      EXPECT_FALSE(IsUsable(input)) << i;
    }
    FrameInput input;
    input.X_WT.p.y = bad;
    EXPECT_FALSE(IsUsable(input));
    input = {};
    input.spindle_rad_per_s = bad;
    EXPECT_FALSE(IsUsable(input));
    input = {};
    input.dt_s = bad;
    EXPECT_FALSE(IsUsable(input));
  }
  FrameInput mirrored, scaled, zero, back, long_ago;
  mirrored.X_WT.R[8] = -1.0;
  scaled.X_WT.R[4] = 1.001;
  zero.X_WT.R = {};
  back.dt_s = -1e-9;
  long_ago.dt_s = 1.1;
  for (const FrameInput& input : {mirrored, scaled, zero, back, long_ago}) EXPECT_FALSE(IsUsable(input));
}

}  // namespace
}  // namespace osteon::simulation
