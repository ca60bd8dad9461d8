#include "simulation/surface/carved_field.h"

#include <algorithm>
#include <bit>
#include <map>

#include <gtest/gtest.h>

#include "simulation/surface/dual_surface.h"
#include "tests/simulation/surface/surface_shapes.h"

namespace osteon::surface {
namespace {

/// Whether place, normal, key and cut flag are equal to the last bit.
bool IsSameVertex(const SurfaceVertex& a, const SurfaceVertex& b) {
  const auto bits = [](const SurfaceVertex& v) {
    return std::array{std::bit_cast<std::uint32_t>(v.p_mm.x),
                      std::bit_cast<std::uint32_t>(v.p_mm.y),
                      std::bit_cast<std::uint32_t>(v.p_mm.z),
                      std::bit_cast<std::uint32_t>(v.normal.x),
                      std::bit_cast<std::uint32_t>(v.normal.y),
                      std::bit_cast<std::uint32_t>(v.normal.z),
                      std::uint32_t{v.key},
                      std::uint32_t{v.cut}};
  };
  return bits(a) == bits(b);
}

bool IsSameChunk(const SurfaceChunk& a, const SurfaceChunk& b) {
  return a.quads == b.quads &&
         std::equal(a.vertices.begin(), a.vertices.end(), b.vertices.begin(), b.vertices.end(), IsSameVertex);
}

/// The chunk of a brick, extracted anew.
SurfaceChunk ChunkOf(const CarvedField& field, BrickIndex brick) {
  SurfaceChunk chunk;
  ExtractChunk(field, brick, chunk);
  return chunk;
}

/// Extracts the chunks of changed bricks anew, as a console page does.
void UpdateChunks(CarvedField& field, std::map<BrickIndex, SurfaceChunk>& chunks) {
  for (const BrickIndex brick : field.Dirty()) ExtractChunk(field, brick, chunks[brick]);
  field.ClearDirty();
}

TEST(CarvedField, UpdatedChunksEqualChunksExtractedAnew) {
  const auto solid = BallField(9.0F, 0.5F);
  CarvedField field(solid);
  std::map<BrickIndex, SurfaceChunk> kept;
  UpdateChunks(field, kept);
  std::mt19937 random(11);
  for (int pass = 0; pass < 12; ++pass) {
    const std::vector<Capsule> way = RandomToolPath(random, 9.0F, 0.7F + 0.3F * static_cast<float>(pass), 40);
    for (std::size_t i = 0; i < way.size(); i += 8) {
      field.Carve(std::span(way).subspan(i, 8));
      UpdateChunks(field, kept);
    }
  }
  std::size_t quads = 0;
  for (BrickIndex brick = 0; brick < field.layout().Count(); ++brick) {
    const SurfaceChunk anew = ChunkOf(field, brick);
    quads += anew.quads.size() / 4;
    ASSERT_TRUE(IsSameChunk(anew, kept[brick])) << "brick " << brick;
  }
  EXPECT_GT(quads, 1000U);
}

TEST(CarvedField, OrderAndBatchesOfCapsulesChangeNoBit) {
  const auto solid = BallField(9.0F, 0.5F);
  std::mt19937 random(12);
  std::vector<Capsule> way;
  for (int pass = 0; pass < 6; ++pass)
    for (const Capsule& c : RandomToolPath(random, 9.0F, 0.7F + 0.5F * static_cast<float>(pass), 50))
      way.push_back(c);
  CarvedField at_once(solid), shuffled(solid);
  at_once.Carve(way);
  std::shuffle(way.begin(), way.end(), random);
  for (std::size_t i = 0; i < way.size(); i += 7)
    shuffled.Carve(std::span(way).subspan(i, std::min<std::size_t>(7, way.size() - i)));
  for (BrickIndex brick = 0; brick < at_once.layout().Count(); ++brick)
    ASSERT_TRUE(IsSameChunk(ChunkOf(at_once, brick), ChunkOf(shuffled, brick))) << "brick " << brick;
}

// Carve skips capsules that other capsules of the same call cover. If each capsule is carved by its own call,
// none can be skipped.
TEST(CarvedField, SkippedCapsulesDoNotChangeTheMesh) {
  const auto solid = BallField(9.0F, 0.5F);
  std::mt19937 random(13);
  const std::vector<Capsule> way = RandomToolPath(random, 5.0F, 4.0F, 60);
  CarvedField together(solid), one_by_one(solid);
  together.Carve(way);
  for (const Capsule& capsule : way) one_by_one.Carve({&capsule, 1});
  for (BrickIndex brick = 0; brick < together.layout().Count(); ++brick)
    ASSERT_TRUE(IsSameChunk(ChunkOf(together, brick), ChunkOf(one_by_one, brick))) << "brick " << brick;
}

TEST(CarvedField, RestoringAnEarlierSweepRestoresItsChunks) {
  CarvedField field(BallField(9.0F, 0.5F));
  std::map<BrickIndex, SurfaceChunk> kept;
  std::mt19937 random(14);
  field.Carve(RandomToolPath(random, 9.0F, 2.0F, 40));
  UpdateChunks(field, kept);
  const std::map<BrickIndex, SurfaceChunk> earlier = kept;
  const BrickField swept = field.swept();
  field.Carve(RandomToolPath(random, 7.0F, 3.0F, 60));
  UpdateChunks(field, kept);
  field.SetSwept(swept);
  EXPECT_LT(field.Dirty().size(), earlier.size()) << "where nothing changed nothing is made again";
  UpdateChunks(field, kept);
  for (const auto& [brick, chunk] : earlier)
    ASSERT_TRUE(IsSameChunk(chunk, kept[brick])) << "brick " << brick;
  EXPECT_THROW(field.SetSwept(BrickField(3, BrickField::kAllLow)), std::invalid_argument);
}

TEST(CarvedField, IsDirtyOnlyNearTheCut) {
  CarvedField field(BallField(9.0F, 0.5F));
  field.ClearDirty();
  const Capsule in_the_air{{20.0F, 0.0F, 0.0F}, {21.0F, 0.0F, 0.0F}, 2.0F};
  field.Carve({&in_the_air, 1});
  EXPECT_TRUE(field.Dirty().empty());
  const Capsule at_the_top{{0.0F, 0.0F, 9.0F}, {0.0F, 0.0F, 9.0F}, 1.0F};
  field.Carve({&at_the_top, 1});
  ASSERT_FALSE(field.Dirty().empty());
  EXPECT_LT(field.Dirty().size(), 28U);  // at most 3 x 3 x 3 bricks
}

TEST(CarvedField, CarvingTheSameCapsuleAgainChangesNothing) {
  CarvedField field(BallField(9.0F, 0.5F));
  const Capsule capsule{{0.0F, 0.0F, 8.0F}, {1.0F, 0.0F, 8.0F}, 3.0F};
  field.Carve({&capsule, 1});
  field.ClearDirty();
  field.Carve({&capsule, 1});
  EXPECT_TRUE(field.Dirty().empty());
}

TEST(CarvedField, ACapsuleAroundTheSolidRemovesAllOfIt) {
  CarvedField field(BallField(3.0F, 0.5F));
  const Capsule all{{0.0F, 0.0F, 0.0F}, {0.0F, 0.0F, 0.0F}, 10.0F};
  field.Carve({&all, 1});
  for (BrickIndex brick = 0; brick < field.layout().Count(); ++brick)
    ASSERT_TRUE(ChunkOf(field, brick).quads.empty());
}

}  // namespace
}  // namespace osteon::surface
