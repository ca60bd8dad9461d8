#include "session/view/bone_difference.h"

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "simulation/surface/dual_surface.h"

namespace osteon::session {
namespace {

using surface::CarvedField;
using surface::SolidField;
using surface::SurfaceChunk;

constexpr float kBall_mm = 9.0F, kTool_mm = 4.0F;

std::shared_ptr<const SolidField> BallOf(float voxel_mm) {
  const surface::Vec3 corner{kBall_mm, kBall_mm, kBall_mm};
  return std::make_shared<const SolidField>(surface::MakeLayout(-1.0F * corner, corner, voxel_mm),
                                            [](surface::Vec3 p) { return surface::Norm(p) - kBall_mm; });
}

// One recording's bone with its map, and the materials that a page has.
struct Side {
  std::shared_ptr<const SolidField> solid;
  CarvedField field;
  DifferenceMap map;
  std::map<surface::BrickIndex, SurfaceChunk> page{};

  Side(BoneDifference& shared, std::size_t side, float voxel_mm)
      : solid(BallOf(voxel_mm)), field(solid), map(shared, side) {}

  // A cut from above, this deep [mm].
  void Cut(float deep_mm) {
    const surface::Vec3 at{0.0F, 0.0F, kBall_mm + kTool_mm - deep_mm};
    const surface::Capsule ball{.a_mm = at, .b_mm = at, .radius_mm = kTool_mm};
    field.Carve(std::span(&ball, 1));
  }

  // What the thread of a view does at each look. @returns the bricks that it sends
  std::size_t Look() {
    if (map.Switched()) field.MarkAllDirty();
    const auto bricks = map.Update(field, solid, field.Dirty());
    for (const surface::BrickIndex brick : bricks) {
      surface::ExtractChunk(field, brick, page[brick]);
      map.Colour(field, page[brick]);
    }
    map.TellLargest();
    field.ClearDirty();
    return bricks.size();
  }

  // Steps of the vertex that is lowest in the cut.
  [[nodiscard]] int StepsAtTheBottom() const {
    const surface::SurfaceVertex* lowest = nullptr;
    for (const auto& [brick, chunk] : page)
      for (const auto& vertex : chunk.vertices)
        if (vertex.cut && (!lowest || vertex.p_mm.z < lowest->p_mm.z)) lowest = &vertex;
    return lowest ? static_cast<int>(lowest->material) - BoneDifference::kZero : -1000;
  }
  [[nodiscard]] bool ShowsNone() const {
    for (const auto& [brick, chunk] : page)
      for (const auto& vertex : chunk.vertices)
        if (vertex.material != BoneDifference::kZero) return false;
    return true;
  }
};

struct BoneDifferenceTest : testing::Test {
  BoneDifference shared;
  void LookUntilStill(Side& first, Side& second) {
    for (int looks = 0; looks < 10; ++looks)
      if (first.Look() + second.Look() == 0) return;
    ADD_FAILURE() << "the map never comes to rest";
  }
  [[nodiscard]] nlohmann::json Note() const { return nlohmann::json::parse(shared.Json()); }
};

TEST_F(BoneDifferenceTest, EqualBonesDifferInNothing) {
  Side first(shared, 0, 0.5F), second(shared, 1, 0.5F);
  shared.Show(true);
  first.Cut(2.0F);
  second.Cut(2.0F);
  LookUntilStill(first, second);
  EXPECT_TRUE(first.ShowsNone());
  EXPECT_TRUE(second.ShowsNone());
  EXPECT_EQ(Note()["largest_mm"], 0.0);
}

TEST_F(BoneDifferenceTest, TheDeeperCutIsSeenOnBothSidesWithItsDepth) {
  constexpr float kDeeper_mm = 0.4F;
  Side first(shared, 0, 0.5F), second(shared, 1, 0.5F);
  shared.Show(true);
  first.Cut(2.0F);
  LookUntilStill(first, second);
  EXPECT_LT(first.StepsAtTheBottom(), 0) << "the second is not cut at all";
  second.Cut(2.0F + kDeeper_mm);
  LookUntilStill(first, second);  // the first side's own bone has not changed
  const double expected = kDeeper_mm / BoneDifference::StepFor(0.5F);
  EXPECT_NEAR(first.StepsAtTheBottom(), expected, 1.0);
  EXPECT_NEAR(second.StepsAtTheBottom(), expected, 1.0);
  EXPECT_NEAR(Note()["largest_mm"].get<double>(), kDeeper_mm, 0.03);
  EXPECT_LT(Note()["at_mm"][2].get<double>(), kBall_mm - 1.9) << "at the cut's bottom";
  EXPECT_EQ(Note()["range_mm"], 0.5);
}

TEST_F(BoneDifferenceTest, BonesOfOtherGridsAreCompared) {
  Side first(shared, 0, 0.5F), second(shared, 1, 0.4F);
  shared.Show(true);
  first.Cut(2.4F);
  second.Cut(2.0F);
  LookUntilStill(first, second);
  EXPECT_NEAR(Note()["largest_mm"].get<double>(), -0.4, 0.04) << "the first is deeper";
  EXPECT_NEAR(Note()["limit_mm"].get<double>(), 1.5, 1e-6);
}

TEST_F(BoneDifferenceTest, OffItCopiesNothingAndLeavesTheTissue) {
  Side first(shared, 0, 0.5F), second(shared, 1, 0.5F);
  first.Cut(2.0F);
  LookUntilStill(first, second);
  EXPECT_EQ(shared.Take(1).bone.solid, nullptr);
  EXPECT_EQ(first.StepsAtTheBottom(), -BoneDifference::kZero) << "material 0";
  shared.Show(true);
  LookUntilStill(first, second);
  EXPECT_LT(first.StepsAtTheBottom(), 0);
  EXPECT_GT(first.StepsAtTheBottom(), -BoneDifference::kZero);
  shared.Show(false);
  LookUntilStill(first, second);
  EXPECT_EQ(first.StepsAtTheBottom(), -BoneDifference::kZero) << "material 0 again";
}

}  // namespace
}  // namespace osteon::session
