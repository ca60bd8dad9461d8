#include "simulation/surface/loose_pieces.h"

#include <numbers>

#include <gtest/gtest.h>

#include "tests/simulation/surface/surface_shapes.h"

namespace osteon::surface {
namespace {

/// The surface of solid balls that don't touch each other.
WeldedSurface Balls(const std::vector<Capsule>& balls) {
  Vec3 min{}, max{};
  for (const Capsule& ball : balls) {
    const Vec3 r{ball.radius_mm, ball.radius_mm, ball.radius_mm};
    const Vec3 a = ball.a_mm - r, b = ball.a_mm + r;
    min = {std::min(min.x, a.x), std::min(min.y, a.y), std::min(min.z, a.z)};
    max = {std::max(max.x, b.x), std::max(max.y, b.y), std::max(max.z, b.z)};
  }
  return WeldSurface(CarvedField(
      std::make_shared<const SolidField>(MakeLayout(min, max, 0.25F), std::span<const Capsule>(balls))));
}

Capsule Ball(float x, float radius_mm) { return {{x, 0.0F, 0.0F}, {x, 0.0F, 0.0F}, radius_mm}; }

double BallVolume_mm3(double radius_mm) { return 4.0 / 3.0 * std::numbers::pi * std::pow(radius_mm, 3); }

TEST(LoosePieces, PiecesBelowTheBoundAreDroppedAndTheRestStaysClosed) {
  WeldedSurface mesh = Balls({Ball(0.0F, 4.0F), Ball(7.0F, 1.0F), Ball(10.0F, 1.5F)});
  const PieceFigures figures = DropPiecesBelow(8.0, mesh);
  EXPECT_EQ(figures.pieces, 3U);
  EXPECT_EQ(figures.dropped, 1U) << "4.2 mm³ is below 8 mm³, 14.1 mm³ is not";
  EXPECT_NEAR(figures.dropped_mm3, BallVolume_mm3(1.0), 0.3);
  EXPECT_NEAR(VolumeOf(mesh), BallVolume_mm3(4.0) + BallVolume_mm3(1.5), 2.0);
  const EdgeCounts edges = CountEdges(mesh);
  EXPECT_EQ(edges.open + edges.over_shared, 0U);
  for (const auto& quad : mesh.quads)
    for (const std::uint32_t v : quad) ASSERT_LT(v, mesh.vertices_mm.size());
}

TEST(LoosePieces, WithABoundOfZeroPiecesAreOnlyCounted) {
  WeldedSurface mesh = Balls({Ball(0.0F, 3.0F), Ball(6.0F, 1.0F)});
  const std::size_t quads = mesh.quads.size();
  const PieceFigures figures = DropPiecesBelow(0.0, mesh);
  EXPECT_EQ(figures.pieces, 2U);
  EXPECT_EQ(figures.dropped, 0U);
  EXPECT_EQ(mesh.quads.size(), quads);
}

TEST(LoosePieces, TheLargestPieceIsNeverDropped) {
  WeldedSurface mesh = Balls({Ball(0.0F, 3.0F), Ball(6.0F, 1.0F)});
  EXPECT_EQ(DropPiecesBelow(1e9, mesh).dropped, 1U);
  EXPECT_NEAR(VolumeOf(mesh), BallVolume_mm3(3.0), 1.0);
}

// The surface of a hollow is a separate shell, turned inside out. It belongs to the bone around it and must
// stay.
TEST(LoosePieces, AHollowWithinBoneIsNotCountedAsAPiece) {
  CarvedField field(BallField(5.0F, 0.25F));
  const Capsule inner = Ball(0.0F, 1.5F);
  field.Carve({&inner, 1});
  WeldedSurface mesh = WeldSurface(field);
  const double volume_mm3 = VolumeOf(mesh);
  const PieceFigures figures = DropPiecesBelow(100.0, mesh);
  EXPECT_EQ(figures.pieces, 1U);
  EXPECT_EQ(VolumeOf(mesh), volume_mm3);
  EXPECT_NEAR(volume_mm3, BallVolume_mm3(5.0) - BallVolume_mm3(1.5), 3.0);
}

TEST(LoosePieces, AnEmptyMeshHasNoPieces) {
  WeldedSurface mesh;
  EXPECT_EQ(DropPiecesBelow(1.0, mesh).pieces, 0U);
}

}  // namespace
}  // namespace osteon::surface
