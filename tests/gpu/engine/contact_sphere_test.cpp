#include <gtest/gtest.h>

#include "simulation/tools/tool_kinds.h"
#include "tests/gpu/engine/engine_twins.h"

// Tests cutting with Cutters::kContactSphere, where only the tool ball that touches first removes bone. In
// each frame, the Vulkan engine must choose the same tool ball as the reference engine; otherwise their bones
// would differ.

namespace osteon::gpu {
namespace {

using simulation::Bone;
using simulation::ContactModel;
using simulation::CuttingParams;
using simulation::FrameInput;
using simulation::RemovalLaw;
using simulation::Tool;

// Parameters with which only the contact sphere cuts.
CuttingParams ContactSphere(RemovalLaw law) {
  return {.law = law, .cutters = simulation::Cutters::kContactSphere};
}

/// The balls of the default bone within 9 mm of the cup's deepest point, of a soft material. This packing has
/// no symmetry and is small enough for the slow reference engine.
Bone FloorOfTheCup() {
  Bone bone = DefaultBone();
  const auto far = [](const Vector3& p) { return (p - Vector3(0, 0, -0.024)).norm() > 9e-3; };
  std::erase_if(bone.balls, [&](const simulation::Ball& ball) { return far(ball.center_m); });
  std::erase_if(bone.points, [&](const simulation::MassPoint& point) { return far(point.p_m); });
  for (simulation::Material& material : bone.materials) material.specific_cutting_energy_J_per_m3 *= 0.01;
  return bone;
}

/// A frame in which the apex is `depth_m` below the cup's floor. The tool is moved by aside_m and rotated by
/// turn.
FrameInput FrameOnTheFloor(double depth_m, const Vector3& aside_m, const Vector3& turn) {
  Pose X_WT = Pose::Identity();
  X_WT.linear() = ExpRotation(turn) * ExpRotation({M_PI, 0, 0});
  X_WT.translation() = Vector3(0, 0, -0.024 - depth_m) + aside_m;
  return {.X_WT = X_WT, .spindle_rad_per_s = kSpindle_rad_per_s, .dt_s = 1e-3};
}

// A head of 120 balls is pressed in slowly while it turns. Every fifth ball does not cut.
TEST(ContactSphere, ReamsLikeTheReference) {
  EnginePair engines(FloorOfTheCup(), Shell(120), {}, ContactSphere(RemovalLaw::kRate));
  for (int i = 0; i < 600; ++i)
    engines.Step(FrameOnTheFloor(-0.1e-3 + 3e-6 * i,
                                 {0.2e-3 * std::sin(0.03 * i), 0.2e-3 * std::sin(0.02 * i), 0},
                                 {0.1 * std::sin(0.011 * i), 0.08 * std::sin(0.017 * i), 0.029 * i}));
  engines.ExpectWithinTolerances({.force_N = 5.0, .touching = 300, .balls = 20, .points = 5});
}

// A drill moves straight down under the immediate law. It has three cutting balls at its tip; the balls of
// its shaft do not cut.
TEST(ContactSphere, DrillsLikeTheReferenceUnderTheImmediateLaw) {
  Tool drill;
  for (int i = 0; i < 3; ++i)
    drill.balls.push_back(
        {.center_m = Vector3(0.9e-3 * std::cos(2.1 * i), 0.9e-3 * std::sin(2.1 * i), -1.2e-3),
         .radius_m = 1.1e-3 + 0.1e-3 * i});
  for (int i = 0; i < 8; ++i)
    drill.balls.insert(drill.balls.begin(),
                       {.center_m = Vector3(0, 0, -3.2e-3 - 1e-3 * i), .radius_m = 1.4e-3, .cutting = false});
  EnginePair engines(FloorOfTheCup(), drill, {}, ContactSphere(RemovalLaw::kImmediate));
  for (int i = 0; i < 300; ++i)
    engines.Step(FrameOnTheFloor(-0.1e-3 + 1e-5 * i, {1e-6 * i, 0, 0}, {0, 0, 0.05 * i}));
  engines.ExpectWithinTolerances({.force_N = 0.1, .touching = 200, .balls = 20, .points = 5});
}

// The tool turns so far within a frame that the engine divides the frame into parts. Each part has its own
// first contact and cuts with the tool ball of that contact.
TEST(ContactSphere, CutsLikeTheReferenceInAFrameOfSeveralParts) {
  EnginePair engines(FloorOfTheCup(), Shell(40), {}, ContactSphere(RemovalLaw::kImmediate));
  for (int i = 0; i < 40; ++i)
    engines.Step(FrameOnTheFloor(-0.1e-3 + 2e-5 * i, {0, 0, 0},
                                 {0.4 * std::sin(0.7 * i), 0.3 * std::sin(0.5 * i), 0.3 * i}));
  engines.ExpectWithinTolerances({.force_N = 0.1, .touching = 20, .balls = 10, .points = 1});
}

TEST(ContactSphere, WithOneCuttingBallCutsLikeTheLawOfAllBalls) {
  const Bone bone = FloorOfTheCup();
  const Tool burr = simulation::MakeReamer(2e-3, 0.8e-3, 8e-3, 0.9, Vector3::Zero());
  CuttingParams alone = ContactSphere(RemovalLaw::kRate), all = alone;
  all.cutters = simulation::Cutters::kAll;
  const auto one = Open(bone, burr, {}, alone), two = Open(bone, burr, {}, all);
  const ContactModel last = ExpectSameBits(*one, *two, 200, [](int i, const ContactModel&) {
    return FrameOnTheFloor(-0.1e-3 + 5e-6 * i, {1e-6 * i, 0, 0}, {0, 0, 0});
  });
  EXPECT_GT(last.removed_volume_m3, 1e-10);
}

TEST(ContactSphere, TwoRunsAreBitIdentical) {
  const Bone bone = FloorOfTheCup();
  const Tool tool = Shell(300);
  const CuttingParams params = ContactSphere(RemovalLaw::kImmediate);
  const auto one = Open(bone, tool, {}, params), two = Open(bone, tool, {}, params);
  const std::uint64_t uncut = simulation::HashState(one->Snapshot());
  ExpectSameBits(*one, *two, 200, [](int i, const ContactModel&) {
    return FrameOnTheFloor(-0.1e-3 + 6e-6 * i, {0.2e-3 * std::sin(0.03 * i), 0, 0}, {0, 0.1, 0.03 * i});
  });
  EXPECT_NE(simulation::HashState(one->Snapshot()), uncut);
}

}  // namespace
}  // namespace osteon::gpu
