#include "session/view/bone_difference.h"

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "simulation/surface/dual_surface.h"

// Tests of the map that colours the difference between the bones of two recordings on both pages.

namespace osteon::session {
namespace {

using surface::CarvedField;
using surface::SolidField;
using surface::SurfaceChunk;

// The bone is a ball about G's origin; the tool is a smaller ball.
constexpr float kBoneRadius_mm = 9.0F, kToolRadius_mm = 4.0F;

// The uncut bone as a field of distances on a grid of this spacing.
std::shared_ptr<const SolidField> MakeBallBone(float voxel_mm) {
  const surface::Vec3 corner{kBoneRadius_mm, kBoneRadius_mm, kBoneRadius_mm};
  return std::make_shared<const SolidField>(
      surface::MakeLayout(-1.0F * corner, corner, voxel_mm),
      [](surface::Vec3 p) { return surface::Norm(p) - kBoneRadius_mm; });
}

// One side of the comparison: a recording's bone, its difference map, and the chunks that its page shows.
struct Side {
  std::shared_ptr<const SolidField> solid;
  CarvedField field;
  DifferenceMap map;
  std::map<surface::BrickIndex, SurfaceChunk> shown_chunks{};

  Side(BoneDifference& shared, std::size_t side, float voxel_mm)
      : solid(MakeBallBone(voxel_mm)), field(solid), map(shared, side) {}

  // Presses the tool into the bone's top to this depth.
  void Cut(float depth_mm) {
    const surface::Vec3 at{0.0F, 0.0F, kBoneRadius_mm + kToolRadius_mm - depth_mm};
    const surface::Capsule ball{.a_mm = at, .b_mm = at, .radius_mm = kToolRadius_mm};
    field.Carve(std::span(&ball, 1));
  }

  // Updates the map and the shown chunks as a view's thread does periodically.
  // @returns the number of bricks that it sends
  std::size_t UpdatePage() {
    if (map.Switched()) field.MarkAllDirty();
    const auto bricks = map.Update(field, solid, field.Dirty());
    for (const surface::BrickIndex brick : bricks) {
      surface::ExtractChunk(field, brick, shown_chunks[brick]);
      map.Colour(field, shown_chunks[brick]);
    }
    map.TellLargest();
    field.ClearDirty();
    return bricks.size();
  }

  // Difference in steps (see BoneDifference::kZero) at the lowest vertex of the cut; -1000 without a cut.
  [[nodiscard]] int StepsAtCutBottom() const {
    const surface::SurfaceVertex* lowest = nullptr;
    for (const auto& [brick, chunk] : shown_chunks)
      for (const auto& vertex : chunk.vertices)
        if (vertex.cut && (!lowest || vertex.p_mm.z < lowest->p_mm.z)) lowest = &vertex;
    return lowest ? static_cast<int>(lowest->material) - BoneDifference::kZero : -1000;
  }
  [[nodiscard]] bool ShowsNoDifference() const {
    for (const auto& [brick, chunk] : shown_chunks)
      for (const auto& vertex : chunk.vertices)
        if (vertex.material != BoneDifference::kZero) return false;
    return true;
  }
};

// The state that both sides share, with its message to the pages.
struct BoneDifferenceTest : testing::Test {
  BoneDifference shared;
  // Updates both pages in turn until neither has a brick to send.
  void UpdateUntilSettled(Side& first, Side& second) {
    for (int updates = 0; updates < 10; ++updates)
      if (first.UpdatePage() + second.UpdatePage() == 0) return;
    ADD_FAILURE() << "the map never comes to rest";
  }
  [[nodiscard]] nlohmann::json Message() const { return nlohmann::json::parse(shared.Json()); }
};

TEST_F(BoneDifferenceTest, EqualBonesShowNoDifference) {
  Side first(shared, 0, 0.5F), second(shared, 1, 0.5F);
  shared.Show(true);
  first.Cut(2.0F);
  second.Cut(2.0F);
  UpdateUntilSettled(first, second);
  EXPECT_TRUE(first.ShowsNoDifference());
  EXPECT_TRUE(second.ShowsNoDifference());
  EXPECT_EQ(Message()["largest_mm"], 0.0);
}

TEST_F(BoneDifferenceTest, ADeeperCutIsShownOnBothSidesWithItsDepth) {
  constexpr float kDeeper_mm = 0.4F;
  Side first(shared, 0, 0.5F), second(shared, 1, 0.5F);
  shared.Show(true);
  first.Cut(2.0F);
  UpdateUntilSettled(first, second);
  EXPECT_LT(first.StepsAtCutBottom(), 0) << "the second is not cut at all";
  second.Cut(2.0F + kDeeper_mm);
  UpdateUntilSettled(first, second);  // the first page must change although its own bone has not
  const double expected = kDeeper_mm / BoneDifference::StepFor(0.5F);
  EXPECT_NEAR(first.StepsAtCutBottom(), expected, 1.0);
  EXPECT_NEAR(second.StepsAtCutBottom(), expected, 1.0);
  EXPECT_NEAR(Message()["largest_mm"].get<double>(), kDeeper_mm, 0.03);
  EXPECT_LT(Message()["at_mm"][2].get<double>(), kBoneRadius_mm - 1.9) << "at the cut's bottom";
  EXPECT_EQ(Message()["range_mm"], 0.5);
}

TEST_F(BoneDifferenceTest, BonesOfDifferentVoxelSizesAreCompared) {
  Side first(shared, 0, 0.5F), second(shared, 1, 0.4F);
  shared.Show(true);
  first.Cut(2.4F);
  second.Cut(2.0F);
  UpdateUntilSettled(first, second);
  EXPECT_NEAR(Message()["largest_mm"].get<double>(), -0.4, 0.04) << "the first is deeper";
  EXPECT_NEAR(Message()["limit_mm"].get<double>(), 1.5, 1e-6);
}

// While the map is off, vertices keep their tissue: material 0, which reads as -kZero steps.
TEST_F(BoneDifferenceTest, CopiesNothingAndKeepsTheTissueWhileOff) {
  Side first(shared, 0, 0.5F), second(shared, 1, 0.5F);
  first.Cut(2.0F);
  UpdateUntilSettled(first, second);
  EXPECT_EQ(shared.Take(1).bone.solid, nullptr);
  EXPECT_EQ(first.StepsAtCutBottom(), -BoneDifference::kZero) << "material 0";
  shared.Show(true);
  UpdateUntilSettled(first, second);
  EXPECT_LT(first.StepsAtCutBottom(), 0);
  EXPECT_GT(first.StepsAtCutBottom(), -BoneDifference::kZero);
  shared.Show(false);
  UpdateUntilSettled(first, second);
  EXPECT_EQ(first.StepsAtCutBottom(), -BoneDifference::kZero) << "material 0 again";
}

}  // namespace
}  // namespace osteon::session
