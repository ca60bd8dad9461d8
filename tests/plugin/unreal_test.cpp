#include <chrono>
#include <cmath>
#include <set>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "OsteonBoneComponent.h"

// The Unreal component against stubs of Unreal's types: everything but the engine itself runs.

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

  /// Moves the tool, lets the engine compute, and ticks.
  void Show(const FTransform& pose) {
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
  Show(bone.Approach(-1.7));
  ASSERT_EQ(osteon_session_surface_wait(bone.Session().session()), OSTEON_OK) << osteon_last_error();
  bone.UpdateMesh();
  const std::size_t uncut = Triangles(bone);
  EXPECT_GT(uncut, 1000U);
  double pushed_N = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const FTransform pose = bone.Approach(-1.7 - 0.0008 * i);
    Show(pose);
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
      // as in UKismetProceduralMeshLibrary::GenerateBoxMesh: seen from where (c - a) × (b - a) points
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

// The component's own frame counts: bone and tool moved together give the same force.
TEST_F(UnrealComponent, TakesTheToolInItsOwnFrame) {
  bone.Scene = "thin_plate";
  bone.Tool = &tool;
  bone.BeginPlay();
  const FTransform world(FQuat(0.0, 0.0, std::sqrt(0.5), std::sqrt(0.5)), FVector(10.0, 20.0, 30.0));
  bone.Transform = world;
  const FTransform local = bone.Approach(10.0);
  tool.Transform = FTransform(world.GetRotation() * local.GetRotation(),
                              world.GetLocation() + world.GetRotation().RotateVector(local.GetLocation()));
  for (int i = 0; i < 50; ++i) Show(tool.Transform);
  host::Pose proxy;
  ASSERT_EQ(bone.Session().Proxy(&proxy), OSTEON_OK) << osteon_last_error();
  EXPECT_NEAR(proxy.position[0], local.GetLocation().X, 1e-9);
  EXPECT_NEAR(proxy.position[1], local.GetLocation().Y, 1e-9);
  EXPECT_NEAR(proxy.position[2], 10.0, 1e-9);
}

TEST_F(UnrealComponent, SaysWhatIsWrongOnce) {
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

}  // namespace
}  // namespace osteon
