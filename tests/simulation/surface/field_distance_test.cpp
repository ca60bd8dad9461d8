#include "simulation/surface/field_distance.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "simulation/surface/dual_surface.h"
#include "tests/simulation/surface/surface_shapes.h"

namespace osteon::surface {
namespace {

constexpr float kRadius_mm = 9.0F, kVoxel_mm = 0.5F;

/// A ball of bone, carved by a tool ball centred on the bone's top (z = kRadius_mm).
CarvedField CutBall(float tool_radius_mm) {
  CarvedField field(BallField(kRadius_mm, kVoxel_mm));
  const Capsule ball{
      .a_mm = {0.0F, 0.0F, kRadius_mm}, .b_mm = {0.0F, 0.0F, kRadius_mm}, .radius_mm = tool_radius_mm};
  field.Carve(std::span(&ball, 1));
  return field;
}

double DistanceOf(const CarvedField& field, Vec3 p_mm) {
  return CarvedDistance(field.layout(), field.solid(), field.swept(), p_mm);
}

// Oracle: the exact distance, which is the greater of the distances to the bone's ball and out of the tool's.
TEST(CarvedDistance, EqualsTheExactDistanceOfABallMinusABall) {
  constexpr float kTool_mm = 4.0F;
  const CarvedField field = CutBall(kTool_mm);
  // interpolation on a sphere, h²/8 (2/R), 1 mm inside the smaller ball, plus the fields' rounding
  constexpr double kInterpolation_mm =
      kVoxel_mm * kVoxel_mm / 4.0 / (kTool_mm - 1.0) + kVoxel_mm / kStepsOfVoxel;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> along(-10.0F, 10.0F);
  int near = 0, swept = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p_mm{along(random), along(random), along(random)};
    const double to_ball_mm = Norm(p_mm) - kRadius_mm,
                 to_tool_mm = kTool_mm - Norm(p_mm - Vec3{0.0F, 0.0F, kRadius_mm});
    const double expected_mm = std::max(to_ball_mm, to_tool_mm);
    if (std::abs(expected_mm) > 1.0) continue;  // within 1 mm, no surrounding node is clamped
    ++near;
    swept += to_tool_mm > to_ball_mm ? 1 : 0;
    ASSERT_NEAR(DistanceOf(field, p_mm), expected_mm, kInterpolation_mm)
        << p_mm.x << " " << p_mm.y << " " << p_mm.z;
  }
  EXPECT_GT(near, 1000);
  EXPECT_GT(swept, 50);
}

TEST(CarvedDistance, IsClampedToTheBandAndIsAirBeyondTheGrid) {
  const CarvedField field = CutBall(4.0F);
  EXPECT_EQ(DistanceOf(field, {0.0F, 0.0F, 0.0F}), -kBandVoxels * kVoxel_mm);
  EXPECT_EQ(DistanceOf(field, {0.0F, 0.0F, 8.0F}), kBandVoxels * kVoxel_mm) << "in the cut";
  for (const float far_mm : {-1e3F, 1e3F, 1e30F})
    EXPECT_EQ(DistanceOf(field, {0.0F, far_mm, 0.0F}), kBandVoxels * kVoxel_mm);
}

TEST(CarvedDistance, IsNearlyZeroAtTheMeshesVertices) {
  const CarvedField field = CutBall(4.0F);
  SurfaceChunk chunk;
  double largest_mm = 0.0;
  int vertices = 0;
  for (BrickIndex brick = 0; brick < field.layout().Count(); ++brick) {
    ExtractChunk(field, brick, chunk);
    for (const SurfaceVertex& vertex : chunk.vertices) {
      largest_mm = std::max(largest_mm, std::abs(DistanceOf(field, vertex.p_mm)));
      ++vertices;
    }
  }
  EXPECT_GT(vertices, 1000);
  // the vertices at the rim have the largest error, because one Newton step places them on two fields
  EXPECT_LT(largest_mm, 0.15 * kVoxel_mm);
}

TEST(SameAround, DetectsAChangeOfTheBrickOrItsNeighbours) {
  CarvedField first = CutBall(4.0F), second = CutBall(4.0F);
  const auto solid = BallField(kRadius_mm, kVoxel_mm);
  const auto same_in_all = [&](const CarvedField& a, const CarvedField& b) {
    const CarvedSnapshot other{.solid = solid, .swept = std::make_shared<const BrickField>(b.swept())};
    BrickIndex same = 0;
    for (BrickIndex brick = 0; brick < a.layout().Count(); ++brick)
      same += SameAround(a, other, brick) ? 1 : 0;
    return same;
  };
  EXPECT_EQ(same_in_all(first, second), first.layout().Count());
  const Capsule touch{
      .a_mm = {0.0F, 0.0F, -kRadius_mm}, .b_mm = {0.0F, 0.0F, -kRadius_mm}, .radius_mm = 1.0F};
  second.ClearDirty();
  second.Carve(std::span(&touch, 1));
  // every dirty brick must count as changed
  EXPECT_LE(same_in_all(first, second) + second.Dirty().size(), first.layout().Count());
  const CarvedSnapshot finer{.solid = BallField(kRadius_mm, 0.5F * kVoxel_mm), .swept = nullptr};
  EXPECT_FALSE(SameAround(first, finer, 0)) << "another grid";
}

}  // namespace
}  // namespace osteon::surface
