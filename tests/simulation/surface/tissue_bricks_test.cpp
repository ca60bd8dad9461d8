#include "simulation/surface/tissue_bricks.h"

#include <gtest/gtest.h>

#include "tests/simulation/surface/surface_shapes.h"

namespace osteon::surface {
namespace {

// A ball of tissue 2 with a shell of tissue 1, carved so that the cut face shows both. Counts the tissue's
// queries.
struct ShelledBall {
  CarvedField field{BallField(9.0F, 0.5F)};
  std::size_t queries{0};

  ShelledBall() {
    const Capsule cut{.a_mm = {-9.0F, 0.0F, 9.0F}, .b_mm = {9.0F, 0.0F, 9.0F}, .radius_mm = 6.0F};
    field.Carve(std::span(&cut, 1));
  }
  MaterialAt Tissue() {
    return [this](Vec3 p) {
      ++queries;
      return static_cast<std::uint8_t>(Norm(p) > 7.0F ? 1 : 2);
    };
  }
};

TEST(TissueBricks, GivesTheSolidsTissueWithFewQueries) {
  ShelledBall ball;
  TissueBricks tissue(ball.field.layout(), ball.Tissue());
  SurfaceChunk chunk, direct;
  std::size_t vertices = 0, of_core = 0, wrong = 0, queries = 0;
  for (int pass = 0; pass < 4; ++pass)  // during a cut, a brick is extracted many times
    for (BrickIndex brick = 0; brick < ball.field.layout().Count(); ++brick) {
      ball.queries = 0;
      ExtractChunk(ball.field, brick, chunk, {}, tissue.OfBrick(brick));
      queries += ball.queries;
      ExtractChunk(ball.field, brick, direct, {}, ball.Tissue());
      ASSERT_EQ(chunk.vertices.size(), direct.vertices.size());
      for (std::size_t i = 0; i < chunk.vertices.size(); ++i) {
        ++vertices;
        of_core += direct.vertices[i].material == 2 ? 1 : 0;
        wrong += chunk.vertices[i].material != direct.vertices[i].material ? 1 : 0;
      }
    }
  EXPECT_GT(of_core, 100U);
  EXPECT_EQ(wrong, 0U);
  EXPECT_LT(queries, vertices);
}

TEST(TissueBricks, WithoutATissueFunctionEverythingIsTissue0) {
  const ShelledBall ball;
  TissueBricks tissue(ball.field.layout(), {});
  EXPECT_EQ(tissue.At(3, {0.0F, 0.0F, 0.0F}), 0);
}

}  // namespace
}  // namespace osteon::surface
