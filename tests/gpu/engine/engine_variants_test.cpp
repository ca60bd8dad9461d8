#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "gpu/context/context.h"
#include "tests/gpu/engine/engine_twins.h"
#include "tests/gpu/engine/strip_bench.h"

// Tests the engine's variants for other devices on the present device: passes for a GPU (whose last workgroup
// solves and reports) or for a processor, subgroup sizes, few workgroups, keys with room for more balls, and
// arithmetic without 64-bit integers or doubles. All variants must give the same bits, or the results of the
// reference engine within its tolerances.

namespace osteon::gpu {
namespace {

using simulation::ContactModel;
using simulation::CuttingParams;
using simulation::FrameInput;

// Parameters of an engine that uses these variants instead of the variants that suit the device.
VulkanParams With(const VulkanOverrides& overrides) {
  VulkanParams params;
  params.overrides = overrides;
  return params;
}
constexpr VulkanOverrides kForGpu{.variant = PassVariant::kGpu},
    kForProcessor{.variant = PassVariant::kProcessor};

// Frame i of a stroke along the strip. In every 50th frame the spindle is at rest.
FrameInput StrokeInput(int i) {
  return {.X_WT = Stroke(i), .spindle_rad_per_s = i % 50 == 49 ? 0.0 : kSpindle_rad_per_s};
}

// A strip of bone with more balls than one workgroup handles, and with mass points in the tool's path.
simulation::Bone LongStrip() {
  simulation::Bone bone = Strip(150);
  for (simulation::MassPoint& point : bone.points) point.p_m.z = -0.1e-3;
  return bone;
}

TEST(GpuPasses, GiveTheSameBitsAsThoseForAProcessor) {
  for (const int balls :
       {1,
        60}) {  // one cutting ball, for which no packed pairs are needed; then 60 cutting balls and a shaft
    const simulation::Tool tool = balls == 1 ? Ball(6e-3) : Shell(balls);
    const auto gpu = Open(LongStrip(), tool, With(kForGpu)),
               processor = Open(LongStrip(), tool, With(kForProcessor));
    const ContactModel last =
        ExpectSameBits(*gpu, *processor, 150, [](int i, const ContactModel&) { return StrokeInput(i); });
    EXPECT_GT(last.removed_volume_m3, 1e-9) << "something was cut";
  }
}

TEST(GpuPasses, GiveTheSameBitsWithTheContactSphere) {
  const CuttingParams params{.law = simulation::RemovalLaw::kImmediate,
                             .cutters = simulation::Cutters::kContactSphere};
  const auto gpu = Open(LongStrip(), Shell(60), With(kForGpu), params),
             processor = Open(LongStrip(), Shell(60), With(kForProcessor), params);
  ExpectSameBits(*gpu, *processor, 120, [](int i, const ContactModel&) { return StrokeInput(i); });
}

TEST(GpuPasses, GiveTheSameBitsWhereBallsAreSplit) {
  CuttingParams params;
  params.split.on = true;
  params.split.pool_blocks = 64;
  const auto gpu = Open(LongStrip(), Ball(6e-3), With(kForGpu), params),
             processor = Open(LongStrip(), Ball(6e-3), With(kForProcessor), params);
  ExpectSameBits(*gpu, *processor, 120, [](int i, const ContactModel&) { return StrokeInput(i); });
  EXPECT_FALSE(gpu->Snapshot().split_balls.empty());
}

TEST(GpuPasses, GiveTheSameBitsForEveryWayToWaitForTheirEnd) {
  VulkanParams poll = With(kForGpu), wait = poll;
  poll.overrides.fence = FencePolicy::kPoll;
  wait.overrides.fence = FencePolicy::kWait;
  const auto reported = Open(LongStrip(), Ball(6e-3), With(kForGpu)),
             polled = Open(LongStrip(), Ball(6e-3), poll), awaited = Open(LongStrip(), Ball(6e-3), wait);
  for (int i = 0; i < 60; ++i) {
    const ContactModel one = reported->Step(StrokeInput(2 * i));
    ASSERT_TRUE(Identical(one, polled->Step(StrokeInput(2 * i)))) << i;
    ASSERT_TRUE(Identical(one, awaited->Step(StrokeInput(2 * i)))) << i;
  }
}

// A seated reamer has thousands of pairs, so the sums of all workgroups must be combined.
TEST(GpuPasses, ReamLikeTheReference) {
  const simulation::Bone bone = DefaultBone();
  simulation::ReferenceEngine reference(bone, DefaultReamer(), Pose::Identity(), {});
  const auto gpu = Open(bone, DefaultReamer(), With(kForGpu));
  Hand hand;
  ContactModel a;
  FrameDifferences differences;
  for (int i = 0; i < 200; ++i) {
    const FrameInput input = hand.Next(a.F_T_W.f);
    const double path_m = a.frame > 0 ? (Vector3(input.X_WT.p) - Vector3(a.X_WP.p)).norm() : 0.0;
    a = reference.Step(input);
    differences.Add(path_m, a, gpu->Step(input));
  }
  EXPECT_GT(differences.max_N, 80.0);
  EXPECT_EQ(differences.mismatched, 0);
  EXPECT_LE(differences.proxy_mm, 1e-3);
  EXPECT_LE(differences.force_N, 0.02);
}

// Reams with the edge force of the cutting law: with both kinds of passes, and in pairs of floats.
TEST(GpuPasses, ReamWithEdgeForceLikeTheReference) {
  simulation::Bone bone = DefaultBone();
  for (simulation::Material& material : bone.materials) {
    material.measured_chip_m = 50e-6;
    material.edge_force_N_per_m = 0.05 * material.specific_cutting_energy_J_per_m3 * material.measured_chip_m;
  }
  simulation::Tool tool = DefaultReamer();
  tool.balls[0].edges = 2;
  const CuttingParams params{.edge_force = true};
  simulation::ReferenceEngine reference(bone, tool, Pose::Identity(), params);
  std::vector<FrameInput> inputs;
  std::vector<ContactModel> models;
  Hand hand;
  for (int i = 0; i < 80; ++i) {
    inputs.push_back(hand.Next(i > 0 ? Vector3(models.back().F_T_W.f) : Vector3::Zero()));
    models.push_back(reference.Step(inputs.back()));
  }
  EXPECT_GT(models.back().removed_volume_m3, 0.0);
  for (const VulkanOverrides& variant :
       {kForGpu, kForProcessor, VulkanOverrides{.arithmetic = Arithmetic::kFloats}}) {
    const auto gpu = Open(bone, tool, With(variant), params);
    FrameDifferences differences;
    double torque_Nm = 0.0, work_J = 0.0;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      const double path_m = i > 0 ? (Vector3(inputs[i].X_WT.p) - Vector3(models[i - 1].X_WP.p)).norm() : 0.0;
      const ContactModel found = gpu->Step(inputs[i]);
      differences.Add(path_m, models[i], found);
      torque_Nm = std::max(torque_Nm, std::abs(models[i].spindle_torque_Nm - found.spindle_torque_Nm));
      work_J = found.cutting_work_J;
    }
    EXPECT_GT(differences.max_N, 20.0);
    EXPECT_EQ(differences.mismatched, 0);
    EXPECT_LE(differences.proxy_mm, 1e-3);
    EXPECT_LE(differences.force_N, 0.02);
    EXPECT_LE(torque_Nm, 1e-3);
    EXPECT_NEAR(work_J, models.back().cutting_work_J, 0.01 * models.back().cutting_work_J);
  }
}

TEST(Workgroups, AFewDoTheWorkOfManyWithTheSameBits) {
  CuttingParams params;
  params.split.on = true;  // workgroups must load children as well
  params.split.pool_blocks = 64;
  for (const VulkanOverrides& variant : {kForGpu, kForProcessor}) {
    VulkanOverrides few = variant;
    few.max_workgroups = 1;
    const auto one = Open(LongStrip(), Shell(60), With(few), params),
               all = Open(LongStrip(), Shell(60), With(variant), params);
    const ContactModel last =
        ExpectSameBits(*one, *all, 40, [](int i, const ContactModel&) { return StrokeInput(3 * i); });
    EXPECT_GT(last.removed_volume_m3, 1e-9);
  }
}

// Keys with room for 2^28 balls resolve distances only to 2^-23 mm. The contacts must agree within this
// resolution.
TEST(BoneBallBits, ForTheLargestBoneGiveTheReferencesContacts) {
  VulkanOverrides wide;
  wide.bone_ball_bits = 28;
  simulation::ReferenceEngine reference(LongStrip(), Ball(6e-3), Pose::Identity(), {});
  const auto vulkan = Open(LongStrip(), Ball(6e-3), With(wide));
  for (int i = 0; i < 150; ++i) {
    const ContactModel a = reference.Step(StrokeInput(i)), b = vulkan->Step(StrokeInput(i));
    ASSERT_TRUE(HaveSameContact(a, b)) << i;
    ASSERT_EQ(a.contact_count > 0, b.contact_count > 0) << i;
  }
}

// ---- without 64-bit integers, and without doubles

// Overrides with 64-bit integers as two words of 32 bits.
VulkanParams WithWords(VulkanOverrides overrides) {
  overrides.arithmetic = Arithmetic::kWords;
  return With(overrides);
}
// Overrides with doubles as pairs of floats.
VulkanParams WithFloats(VulkanOverrides overrides, Arithmetic arithmetic = Arithmetic::kFloats) {
  overrides.arithmetic = arithmetic;
  return With(overrides);
}

// Many balls of a strip are equal and have equal scores, so the lower words of their keys decide which ball
// is chosen.
TEST(Words, GiveTheSameBitsAs64BitIntegers) {
  CuttingParams contact_sphere, split;
  contact_sphere.cutters = simulation::Cutters::kContactSphere;
  contact_sphere.law = simulation::RemovalLaw::kImmediate;
  split.split.on = true;
  split.split.pool_blocks = 64;
  // six of the twelve combinations, in which each pair of choices occurs. They suffice, because a software
  // driver takes seconds to compile each engine
  struct Case {
    const VulkanOverrides& variant;
    int balls;
    const CuttingParams& params;
  };
  const CuttingParams plain;
  for (const Case& c : {Case{kForGpu, 1, plain}, Case{kForGpu, 60, contact_sphere}, Case{kForGpu, 60, split},
                        Case{kForProcessor, 60, plain}, Case{kForProcessor, 1, contact_sphere},
                        Case{kForProcessor, 1, split}}) {
    const simulation::Tool tool = c.balls == 1 ? Ball(6e-3) : Shell(c.balls);
    const auto words = Open(LongStrip(), tool, WithWords(c.variant), c.params),
               whole = Open(LongStrip(), tool, With(c.variant), c.params);
    ExpectSameBits(*words, *whole, 100, [](int i, const ContactModel&) { return StrokeInput(i); });
  }
}

// A seated reamer has thousands of pairs. Many workgroups add to the same sums, and the lower words overflow
// into the upper words.
TEST(Words, GiveTheSameBitsForASeatedReamer) {
  const simulation::Bone bone = DefaultBone();
  const auto words = Open(bone, DefaultReamer(), WithWords(kForGpu)),
             whole = Open(bone, DefaultReamer(), With(kForGpu));
  Hand hand;
  const ContactModel last = ExpectSameBits(
      *words, *whole, 150, [&](int, const ContactModel& model) { return hand.Next(model.F_T_W.f); });
  EXPECT_GT(Vector3(last.F_T_W.f).norm(), 50.0);
}

TEST(Words, GiveTheSameBitsForTheKeysOfTheLargestBone) {
  VulkanOverrides largest = kForGpu;
  largest.bone_ball_bits = 28;
  const auto words = Open(LongStrip(), Shell(60), WithWords(largest)),
             whole = Open(LongStrip(), Shell(60), With(largest));
  ExpectSameBits(*words, *whole, 100, [](int i, const ContactModel&) { return StrokeInput(i); });
}

// The device is opened without the features that a variant avoids. So the validation layers would report a
// shader that uses one of these features.
TEST(Arithmetic, CausesNoValidationMessages) {
  for (VulkanParams params : {WithWords(kForGpu), WithWords(kForProcessor), WithFloats(kForGpu),
                              WithFloats(kForProcessor), WithFloats(kForGpu, Arithmetic::kFloatsInt64)}) {
    params.validation = true;
    auto opened = VulkanEngine::Create(LongStrip(), Shell(60), Pose::Identity(), {}, params);
    if (!opened && opened.error().find("vulkan-validationlayers") != std::string::npos)
      GTEST_SKIP() << opened.error();
    ASSERT_TRUE(opened.has_value()) << opened.error();
    EXPECT_EQ((*opened)->validation_messages(), 0) << "at opening";
    for (int i = 0; i < 100; ++i) (*opened)->Step(StrokeInput(i));
    EXPECT_EQ((*opened)->validation_messages(), 0) << "in 100 frames, or when the engine before went";
  }
}

// With floats, sums are sums of whole numbers as well. So neither the order of execution nor the use of two
// words for a 64-bit integer may change a bit. The test uses few engines, because a software driver takes
// seconds to compile each.
TEST(Floats, GiveTheSameBitsInGpuAndProcessorPassesAndInEitherIntegers) {
  CuttingParams contact_sphere;
  contact_sphere.cutters = simulation::Cutters::kContactSphere;
  struct Case {
    simulation::Tool tool;
    CuttingParams params;
    Arithmetic on_gpu, on_processor;
  };
  for (const auto& [tool, params, on_gpu, on_processor] :
       {Case{Ball(6e-3), {}, Arithmetic::kFloats, Arithmetic::kFloatsInt64},
        Case{Shell(60), contact_sphere, Arithmetic::kFloatsInt64, Arithmetic::kFloats}}) {
    const auto gpu = Open(LongStrip(), tool, WithFloats(kForGpu, on_gpu), params),
               processor = Open(LongStrip(), tool, WithFloats(kForProcessor, on_processor), params);
    ExpectSameBits(*gpu, *processor, 100, [](int i, const ContactModel&) { return StrokeInput(i); });
  }
}

// An exact product needs an fma() that rounds once, or factors that are split. Both methods agree in every
// bit if and only if the device's fma() rounds once. The engine must have detected whether it does.
TEST(Floats, GiveTheSameBitsByFmaOnlyIfTheDevicesFmaIsFused) {
  const auto context = OpenContext("", false, Arithmetic::kFloats);
  ASSERT_TRUE(context) << context.error();
  const auto split = Open(LongStrip(), Ball(6e-3), WithFloats({.fused_fma = false})),
             fused = Open(LongStrip(), Ball(6e-3), WithFloats({.fused_fma = true}));
  int alike = 0;
  constexpr int kStrokeFrames = 60;
  for (int i = 0; i < kStrokeFrames; ++i)
    if (Identical(split->Step(StrokeInput(i)), fused->Step(StrokeInput(i)))) ++alike;
  EXPECT_EQ(alike == kStrokeFrames, (*context)->fused_fma)
      << alike << " frames alike, " << (*context)->info.name;
}

// ---- subgroup sizes

// Compares an engine on llvmpipe at this vector width with the reference engine. llvmpipe reads the width
// from the environment when it is loaded, so each width needs a process of its own.
// @returns 0 if the engine agrees with all subgroup sizes, or if llvmpipe is missing
int CutsAtVectorWidth(const char* bits) {
  setenv("LP_NATIVE_VECTOR_WIDTH", bits, 1);
  const auto context = OpenContext("llvmpipe", false);
  if (!context) {
    std::fprintf(stderr, "no llvmpipe: %s\n", context.error().c_str());
    return 0;
  }
  const Subgroups& offered = (*context)->subgroups;
  std::fprintf(stderr, "subgroups of %u, full ones %s\n", offered.size,
               offered.can_be_full ? "asked for" : "not known");
  const simulation::Tool tool = Shell(40);
  const simulation::Bone bone = Strip(40);
  for (std::uint32_t size = offered.can_choose ? offered.min_size : offered.size;
       size <= (offered.can_choose ? offered.max_size : offered.size); size *= 2)
    for (const PassVariant variant : {PassVariant::kGpu, PassVariant::kProcessor}) {
      VulkanParams params = With({.variant = variant, .subgroup_size = size});
      params.device = "llvmpipe";
      simulation::ReferenceEngine reference(bone, tool, Pose::Identity(), {});
      const auto vulkan = Open(bone, tool, params);
      for (int i = 0; i < 60; ++i) {
        const ContactModel a = reference.Step(StrokeInput(2 * i)), b = vulkan->Step(StrokeInput(2 * i));
        if (HaveSameContact(a, b)) continue;
        std::fprintf(stderr, "subgroups of %u, passes of kind %d, frame %d differ\n", size,
                     static_cast<int>(variant), i);
        return 1;
      }
    }
  return 0;
}

class SubgroupSizeDeathTest : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(, SubgroupSizeDeathTest, testing::Values(128, 256, 512));

// No device may be opened before the child process starts, because the child runs this code as well.
TEST_P(SubgroupSizeDeathTest, HoldsTheToolLikeTheReference) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(std::exit(CutsAtVectorWidth(std::to_string(GetParam()).c_str())), testing::ExitedWithCode(0),
              "subgroups of " + std::to_string(GetParam() / 32) + ",|no llvmpipe");
}

TEST(SubgroupSize, OneThatTheDeviceLacksIsRefused) {
  const auto engine =
      VulkanEngine::Create(Strip(2), Ball(3e-3), Pose::Identity(), {}, With({.subgroup_size = 3}));
  ASSERT_FALSE(engine.has_value());
  EXPECT_NE(engine.error().find("subgroups of 3: the device accepts "), std::string::npos) << engine.error();
}

TEST(GpuPasses, CauseNoValidationMessages) {
  CuttingParams contact_sphere, split;
  contact_sphere.cutters = simulation::Cutters::kContactSphere;
  split.split.on = true;
  split.split.pool_blocks = 64;
  for (const CuttingParams& cutting : {CuttingParams{}, contact_sphere, split}) {
    VulkanParams params = With(kForGpu);
    params.validation = true;
    auto opened = VulkanEngine::Create(LongStrip(), Shell(60), Pose::Identity(), cutting, params);
    if (!opened && opened.error().find("vulkan-validationlayers") != std::string::npos)
      GTEST_SKIP() << opened.error();
    ASSERT_TRUE(opened.has_value()) << opened.error();
    const int before = (*opened)->validation_messages();
    for (int i = 0; i < 100; ++i) (*opened)->Step(StrokeInput(i));
    (*opened)->Restore((*opened)->Snapshot());
    EXPECT_EQ((*opened)->validation_messages(), before);
    EXPECT_EQ(before, 0);
  }
}

}  // namespace
}  // namespace osteon::gpu
