#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <gtest/gtest.h>

#include "tests/gpu/engine/engine_twins.h"

// Tests the contract of the Vulkan engine: it gives the results of the reference engine and the same bits in
// every run, and causes no validation messages.

namespace osteon::gpu {
namespace {

using simulation::ContactModel;
using simulation::FrameInput;

constexpr int kFrames = 500;  // number of frames of a run that is compared bit by bit

// Number of frames of a long comparison: `needed`, or more if the variable OSTEON_FRAMES says so.
int ManyFrames(int needed) {
  const char* asked = std::getenv("OSTEON_FRAMES");
  return asked ? std::max(needed, std::atoi(asked)) : needed;
}

// An engine that computes in pairs of floats instead of doubles.
const VulkanParams kInFloats{.device = "", .overrides = {.arithmetic = Arithmetic::kFloats}};

// Reams with the default reamer in both engines, guided by a hand.
void ReamOverManyFrames(const VulkanParams& vulkan) {
  EnginePair engines(DefaultBone(), DefaultReamer(), vulkan);
  Hand hand;
  Vector3 f_W = Vector3::Zero();
  const int frames = ManyFrames(1000);
  for (int i = 0; i < frames; ++i) f_W = engines.Step(hand.Next(f_W)).F_T_W.f;
  engines.ExpectWithinTolerances(
      {.force_N = 100.0, .touching = frames * 99 / 100, .balls = 500, .points = 500});
}

TEST(VulkanEngine, ReamsLikeTheReferenceOverManyFrames) { ReamOverManyFrames({}); }
TEST(VulkanEngineInFloats, ReamsLikeTheReferenceOverManyFrames) { ReamOverManyFrames(kInFloats); }

// A burr of 4 mm radius cuts bone whose balls are not much smaller, so that the balls in contact change
// constantly.
void BurrOverManyFrames(const VulkanParams& vulkan) {
  simulation::Tool tool;
  tool.balls.push_back({.center_m = Vector3(0, 0, 4e-3), .radius_m = 4e-3, .cutting = true});
  EnginePair engines(DefaultBone(), tool, vulkan);
  const int frames = ManyFrames(1500);
  for (int i = 0; i < frames; ++i) {
    // the burr moves down into the cup's rim, and at the same time along a figure of eight
    const double phase = 4.0 * M_PI * i / frames, down = std::min(1.0, 3.0 * i / frames);
    FrameInput input{.X_WT = Pose::Identity(), .spindle_rad_per_s = kSpindle_rad_per_s, .dt_s = Hand::kDt};
    input.X_WT.p =
        Vector3(0.029 + 1.5e-3 * std::sin(phase), 0.8e-3 * std::sin(2.0 * phase), 0.4e-3 - 2e-3 * down);
    engines.Step(input);
  }
  engines.ExpectWithinTolerances({.force_N = 5.0, .touching = frames * 3 / 4, .balls = 50, .points = 5});
}

TEST(VulkanEngine, BurrsLikeTheReferenceOverManyFrames) { BurrOverManyFrames({}); }
TEST(VulkanEngineInFloats, BurrsLikeTheReferenceOverManyFrames) { BurrOverManyFrames(kInFloats); }

TEST(VulkanEngine, GivesAHandTheSameForceAsTheReference) {
  const simulation::Bone bone = DefaultBone();
  const simulation::Tool tool = DefaultReamer();
  simulation::ReferenceEngine reference(bone, tool, Pose::Identity(), {});
  const auto vulkan = Open(bone, tool);
  Hand hand, other;  // two hands; each reacts to the force of its own engine
  ContactModel a, b;
  double worst = 0.0, max_N = 0.0;
  for (int i = 0; i < 300; ++i) {
    a = reference.Step(hand.Next(a.F_T_W.f));
    b = vulkan->Step(other.Next(b.F_T_W.f));
    const Vector3 f = a.F_T_W.f, g = b.F_T_W.f;
    max_N = std::max(max_N, f.norm());
    if (f.norm() > 1.0) worst = std::max(worst, (f - g).norm() / f.norm());
  }
  std::printf("closed loop, up to %.1f N: force %.1e of it\n", max_N, worst);
  EXPECT_GT(max_N, 100.0);
  EXPECT_LE(worst, 0.005);
}

TEST(VulkanEngine, TwoRunsAreBitIdentical) {
  const simulation::Bone bone = DefaultBone();
  const auto one = Open(bone, DefaultReamer()), two = Open(bone, DefaultReamer());
  Hand hand;
  ExpectSameBits(*one, *two, kFrames, [&](int, const ContactModel& m) { return hand.Next(m.F_T_W.f); });
}

// A seated reamer has thousands of contacts at once. The device's scheduler decides in which order they are
// summed. This order must not change the sums.
TEST(VulkanEngine, TwoSeatedRunsAreBitIdentical) {
  const simulation::Bone bone = DefaultBone();
  const simulation::Tool fits = simulation::MakeReamer(0.0238, 0.008, 0.12, 0.9, Vector3::Zero());
  const auto one = Open(bone, fits), two = Open(bone, fits);
  Pose X_WT = Pose::Identity();
  X_WT.linear() = Eigen::DiagonalMatrix<double, 3>(1, -1, -1);
  const ContactModel last = ExpectSameBits(*one, *two, 80, [&](int i, const ContactModel&) {
    // moves from just above the floor to 6 mm below it, and a little sideways
    X_WT.translation() = Vector3(2e-4 * std::sin(0.1 * i), 0, -0.0236 - std::min(6e-3, 2e-4 * i));
    return FrameInput{
        .X_WT = X_WT, .spindle_rad_per_s = 26.0, .dt_s = i == 0 ? 0.0 : 2e-3, .stamp = i * 2'000'000};
  });
  // the reamer must be seated and not only touch the rim: it engages at least a tenth of the cup's hemisphere
  // 2 pi R^2
  EXPECT_GT(last.engaged_area_m2, 0.1 * 2.0 * std::numbers::pi * 0.024 * 0.024);
}

TEST(VulkanEngine, ResultsDoNotDependOnListsKeptBetweenFrames) {
  const simulation::Bone bone = DefaultBone();
  const auto keeping = Open(bone, DefaultReamer()), dropping = Open(bone, DefaultReamer());
  Hand hand;
  ExpectSameBits(*keeping, *dropping, kFrames / 2, [&](int i, const ContactModel& model) {
    if (i % 7 == 6)
      dropping->Restore(
          dropping
              ->Snapshot());  // restores the engine's own state, so that only its neighbour lists are dropped
    return hand.Next(model.F_T_W.f);
  });
}

TEST(VulkanEngine, CausesNoValidationMessages) {
  auto opened = VulkanEngine::Create(DefaultBone(), DefaultReamer(), Pose::Identity(), {},
                                     {.device = "", .validation = true, .time_passes = true});
  if (!opened && opened.error().find("vulkan-validationlayers") != std::string::npos)
    GTEST_SKIP() << opened.error();
  ASSERT_TRUE(opened.has_value()) << opened.error();
  VulkanEngine& engine = **opened;
  Hand hand;
  ContactModel model;
  for (int i = 0; i < 120; ++i) model = engine.Step(hand.Next(model.F_T_W.f));
  EXPECT_GT(model.contact_count, 0);
  // then lays the tool on its side over the block, so that its shaft touches
  simulation::CarvedState state = engine.Snapshot();
  state.has_proxy = false;
  engine.Restore(state);
  Pose X_WT = Pose::Identity();
  X_WT.linear() = ExpRotation({0, 0.5 * M_PI, 0});
  for (int i = 0; i < 60; ++i) {
    X_WT.translation() = Vector3(0.115, 0, 0.10 - 0.0016 * i);
    model = engine.Step({.X_WT = X_WT, .spindle_rad_per_s = kSpindle_rad_per_s});
  }
  EXPECT_GT(model.contact_count, 0);
  EXPECT_EQ(model.spindle_torque_Nm, 0.0) << "it was the head that touched";
  EXPECT_FALSE(engine.LastPassTimes().empty());
  EXPECT_EQ(engine.validation_messages(), 0);
}

}  // namespace
}  // namespace osteon::gpu
