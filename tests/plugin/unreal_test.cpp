#include <chrono>
#include <cmath>
#include <cstdio>
#include <set>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "OsteonBoneComponent.h"
#include "OsteonGuidanceComponent.h"
#include "OsteonReamCup.h"

// Unreal's components, compiled with stubs of Unreal's types: everything but Unreal itself runs.

const void* OsteonCuttingModuleIsImplemented();

namespace osteon {
namespace {

const std::string& ConfigFolder() {
  static const std::string folder = OSTEON_SOURCE_DIR "/config";
  return folder;
}

std::size_t Triangles(const UOsteonBoneComponent& bone) {
  std::size_t count = 0;
  for (const auto& [section, mesh] : bone.Shown) count += static_cast<std::size_t>(mesh.Triangles.Num() / 3);
  return count;
}

class UnrealComponent : public testing::Test {
 protected:
  UnrealComponent() {
    bone.ConfigFolder = ConfigFolder().c_str();
    bone.OnRefused.Bound.emplace_back([this](const FString& text) { refusals.emplace_back(*text); });
  }

  /// Moves the tool, ticks the component, and gives the cutting engine 2 ms.
  void MoveToolAndTick(const FTransform& pose) {
    tool.Transform = pose;
    bone.TickComponent(0.002F, LEVELTICK_All, nullptr);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }

  UOsteonBoneComponent bone{FObjectInitializer()};
  USceneComponent tool;
  std::vector<std::string> refusals;
};

TEST_F(UnrealComponent, ReamsTheCupAndItsMeshFollows) {
  bone.Tool = &tool;
  bone.BeginPlay();
  ASSERT_TRUE(bone.IsOpen()) << (refusals.empty() ? "" : refusals.front());
  MoveToolAndTick(bone.Approach(-1.7));
  ASSERT_EQ(osteon_session_surface_wait(bone.Session().session()), OSTEON_OK) << osteon_last_error();
  bone.UpdateMesh();
  const std::size_t uncut = Triangles(bone);
  EXPECT_GT(uncut, 1000U);
  double pushed_N = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const FTransform pose = bone.Approach(-1.7 - 0.0008 * i);
    MoveToolAndTick(pose);
    pushed_N = std::max(pushed_N, bone.GetForce(pose).Z);
  }
  EXPECT_GT(pushed_N, 5.0) << "the bone pushes the reamer out, along +z";
  EXPECT_GT(bone.GetRemovedVolume_mm3(), 50.0);
  ASSERT_EQ(osteon_session_surface_wait(bone.Session().session()), OSTEON_OK);
  bone.UpdateMesh();
  EXPECT_NE(Triangles(bone), uncut);

  long outward = 0, all = 0;
  std::set<int> colors;
  double widest_cm = 0.0;
  for (const auto& [section, mesh] : bone.Shown) {
    for (int i = 0; i + 2 < mesh.Triangles.Num(); i += 3) {
      const FVector a = mesh.Vertices[mesh.Triangles[i]], b = mesh.Vertices[mesh.Triangles[i + 1]],
                    c = mesh.Vertices[mesh.Triangles[i + 2]];
      // Unreal's winding, as in UKismetProceduralMeshLibrary::GenerateBoxMesh: a face is seen from the side
      // to which (c - a) × (b - a) points
      outward += Dot(Cross(c - a, b - a), mesh.Normals[mesh.Triangles[i]]) > 0.0 ? 1 : 0;
      ++all;
    }
    for (const FVector& p : mesh.Vertices) widest_cm = std::max(widest_cm, std::abs(p.X));
    for (const FColor& color : mesh.Colors) colors.insert(color.R << 16 | color.G << 8 | color.B);
  }
  EXPECT_GT(static_cast<double>(outward), 0.98 * static_cast<double>(all));
  EXPECT_GT(widest_cm, 2.0) << "centimetres";
  EXPECT_LT(widest_cm, 20.0) << "centimetres";
  EXPECT_GE(colors.size(), 2U) << "tissues have colours of their own";
  EXPECT_TRUE(refusals.empty()) << refusals.front();
  bone.EndPlay(EEndPlayReason::Destroyed);
  EXPECT_TRUE(bone.Shown.empty());
}

// The session gets the tool's pose in the component's frame: moving bone and tool together changes nothing.
TEST_F(UnrealComponent, TakesTheToolInItsOwnFrame) {
  bone.Scene = "thin_plate";
  bone.Tool = &tool;
  bone.BeginPlay();
  const FTransform world(FQuat(0.0, 0.0, std::sqrt(0.5), std::sqrt(0.5)), FVector(10.0, 20.0, 30.0));
  bone.Transform = world;
  const FTransform local = bone.Approach(10.0);
  tool.Transform = FTransform(world.GetRotation() * local.GetRotation(),
                              world.GetLocation() + world.GetRotation().RotateVector(local.GetLocation()));
  for (int i = 0; i < 50; ++i) MoveToolAndTick(tool.Transform);
  host::Pose proxy;
  ASSERT_EQ(bone.Session().Proxy(&proxy), OSTEON_OK) << osteon_last_error();
  EXPECT_NEAR(proxy.position[0], local.GetLocation().X, 1e-9);
  EXPECT_NEAR(proxy.position[1], local.GetLocation().Y, 1e-9);
  EXPECT_NEAR(proxy.position[2], 10.0, 1e-9);
}

TEST_F(UnrealComponent, ReportsEachRefusalOnce) {
  bone.Scene = "no_such_scene";
  bone.BeginPlay();
  EXPECT_FALSE(bone.IsOpen());
  ASSERT_EQ(refusals.size(), 1U);
  EXPECT_NE(refusals[0].find("no_such_scene"), std::string::npos) << refusals[0];
  bone.Scene = "thin_plate";
  bone.MaxForce_N = -1.0;
  EXPECT_FALSE(bone.Open());
  bone.MaxForce_N = 200.0;
  bone.ToolDiameter_mm = std::nan("");
  EXPECT_FALSE(bone.Open());
  EXPECT_EQ(refusals.size(), 3U);
  bone.ToolDiameter_mm = 0.0;
  ASSERT_TRUE(bone.Open()) << refusals.back();
  const FTransform nowhere(FQuat(), FVector(std::nan(""), 0.0, 0.0));
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(bone.SetToolPose(nowhere));
  EXPECT_EQ(refusals.size(), 4U) << "a text in a row once";
  EXPECT_FALSE(bone.Undo(bone.Approach(10.0))) << "nothing to undo";
  EXPECT_EQ(LoggedTexts().size(), refusals.size());
  bone.Close();
  EXPECT_FALSE(bone.SetToolPose(FTransform()));
  EXPECT_EQ(bone.GetForce(FTransform()).Z, 0.0);
  bone.UpdateMesh();
  EXPECT_NE(OsteonCuttingModuleIsImplemented(), nullptr);
}

TEST_F(UnrealComponent, BoneMovesOnItsMountAndVelocityIsDamped) {
  bone.Tool = &tool;
  ASSERT_TRUE(bone.Open()) << refusals.back();
  FOsteonCompliance compliance;
  compliance.bMount = true;
  compliance.MountPoint = FVector(0.0, 0.0, -2.0);
  ASSERT_TRUE(bone.SetCompliance(compliance)) << refusals.back();
  const FTransform pose = bone.Approach(-1.95);
  FVector force, torque;
  bone.bSpins = false;
  MoveToolAndTick(bone.Approach(0.0));
  for (int i = 0; i < 600; ++i) {
    MoveToolAndTick(pose);
    ASSERT_TRUE(bone.GetWrench(pose, FVector(), FVector(), force, torque)) << refusals.back();
  }
  EXPECT_GT(force.Z, 5.0);
  const FOsteonDeflection deflection = bone.GetDeflection();
  EXPECT_TRUE(deflection.bGivesWay);
  EXPECT_FALSE(deflection.bBeyondLimit);
  EXPECT_LT(deflection.Mount.Z, -0.005) << "centimetres, pushed down";
  EXPECT_NEAR(deflection.Bone.GetLocation().Z, deflection.Mount.Z, 0.02);
  FVector faster;
  ASSERT_TRUE(bone.GetWrench(pose, FVector(0.0, 0.0, -5.0), FVector(), faster, torque));
  EXPECT_GT(faster.Z, force.Z + 1.0) << "damping";
  compliance.MountMass_kg = -3.0;
  EXPECT_FALSE(bone.SetCompliance(compliance));
  EXPECT_NE(refusals.back().find("mass"), std::string::npos) << refusals.back();
}

TEST_F(UnrealComponent, ChangesToolsSavesAndScores) {
  bone.Tool = &tool;
  ASSERT_TRUE(bone.Open()) << refusals.back();
  EXPECT_FALSE(bone.GetEngine().IsEmpty());
  EXPECT_TRUE(bone.GetBoneWarning().IsEmpty());
  EXPECT_STREQ(*UOsteonBoneComponent::GetLibraryVersion(), OSTEON_VERSION);
  const FTransform free = bone.Approach(1.0);
  MoveToolAndTick(free);
  const std::string folder = testing::TempDir() + "osteon_unreal";
  const FString file((folder + ".osp").c_str());
  EXPECT_TRUE(bone.Save(file));
  EXPECT_TRUE(bone.ExportSurface((folder + ".stl").c_str()));
  EXPECT_TRUE(bone.ChangeTool("reamer", 48.0, free)) << refusals.back();
  EXPECT_FALSE(bone.ChangeTool("reamer", 7.0, free));
  EXPECT_TRUE(bone.Restore(file, free)) << refusals.back();
  double score = -1.0;
  TArray<FOsteonScoreItem> items;
  ASSERT_TRUE(bone.Assess("acetabulum", "", score, items)) << refusals.back();
  EXPECT_GE(score, 0.0);
  ASSERT_GT(items.Num(), 3);
  EXPECT_STREQ(*items[0].Metric, "axis_error");
  EXPECT_STREQ(*items[0].Unit, "deg");
  EXPECT_FALSE(bone.Assess("no_such_plan", "", score, items));
  EXPECT_EQ(items.Num(), 0);
  for (const char* end : {".osp", ".osp.swept", ".stl"}) std::remove((folder + end).c_str());
}

TEST(UnrealGuidance, PushesOutAToolThatIsTooDeep) {
  UOsteonGuidanceComponent guidance{FObjectInitializer()};
  std::vector<std::string> refused;
  guidance.OnRefused.Bound.emplace_back([&](const FString& text) { refused.emplace_back(*text); });
  guidance.ConfigFolder = ConfigFolder().c_str();
  guidance.Reamer = 9;
  guidance.BeginPlay();
  EXPECT_FALSE(guidance.IsOpen());
  ASSERT_EQ(refused.size(), 1U);
  guidance.Reamer = 0;
  ASSERT_TRUE(guidance.Open()) << refused.back();
  EXPECT_EQ(guidance.GetReamerCount(), 4);
  const FVector none;
  FVector apex, force, torque;
  double diameter_mm = 0.0;
  ASSERT_TRUE(guidance.GetReamer(0, apex, diameter_mm));
  EXPECT_EQ(std::lround(diameter_mm), 44);
  const FVector axis = guidance.GetCupAxis();
  EXPECT_NEAR(Dot(axis, axis), 1.0, 1e-12);
  // half a turn about the axis halfway between the feed and +z: the feed then points into the cup
  const FVector half(-axis.X, -axis.Y, 1.0 - axis.Z);
  const double length = std::sqrt(Dot(half, half));
  const FQuat into(half.X / length, half.Y / length, half.Z / length, 0.0);
  for (int i = 0; i <= 400; ++i)
    ASSERT_TRUE(guidance.Evaluate(FTransform(into, apex + axis * (0.1 - 0.001 * i)), axis * -1.0, none, none,
                                  none, force, torque))
        << refused.back();
  EXPECT_NEAR(guidance.GetDepth_mm(), 3.0, 0.05);
  EXPECT_GT(Dot(force, axis), 20.0) << "out of the cup, in Unreal's axes";
  EXPECT_TRUE(guidance.SetModelAge(0.1));
  EXPECT_TRUE(guidance.SetGain(0.5));
  EXPECT_FALSE(guidance.SetGain(5.0));
  EXPECT_TRUE(guidance.Reset());
  EXPECT_FALSE(guidance.MustStopSpindle());
  guidance.EndPlay(EEndPlayReason::Destroyed);
  EXPECT_FALSE(guidance.IsOpen());
  EXPECT_FALSE(guidance.Evaluate(FTransform(), FVector(), FVector(), FVector(), FVector(), force, torque));
}

// The sample's actor, ticked as a level of Unreal would tick it.
TEST(UnrealSample, ReamsTheCup) {
  AOsteonReamCup sample;
  EXPECT_TRUE(sample.PrimaryActorTick.bCanEverTick);
  EXPECT_EQ(sample.Tool->AttachParent, sample.RootComponent);
  sample.Bone->ConfigFolder = ConfigFolder().c_str();
  sample.Tick(0.01F);  // play has not begun: no session is open
  sample.Bone->BeginPlay();
  ASSERT_TRUE(sample.Bone->IsOpen());
  LoggedTexts().clear();
  sample.Tool->SetRelativeTransform(sample.Bone->Approach(-1.6));
  for (int i = 0; i < 1100; ++i) {
    sample.Tick(0.005F);
    sample.Bone->TickComponent(0.005F, LEVELTICK_All, nullptr);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_GT(sample.GetLargestForce_N(), 5.0);
  EXPECT_GT(sample.Bone->GetRemovedVolume_mm3(), 50.0);
  ASSERT_EQ(LoggedTexts().size(), 1U) << "at the turn";
  EXPECT_NE(LoggedTexts()[0].find("mm3 removed"), std::string::npos) << LoggedTexts()[0];
  sample.Bone->EndPlay(EEndPlayReason::Destroyed);
}

}  // namespace
}  // namespace osteon
