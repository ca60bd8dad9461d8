#include "simulation/surface/chunk_bytes.h"

#include <random>

#include <gtest/gtest.h>

namespace osteon::surface {
namespace {

const BrickLayout kLayout = MakeLayout({-10.0F, -10.0F, -10.0F}, {10.0F, 10.0F, 10.0F}, 0.5F);

/// A chunk of vertices on the format's lattice (28 steps per voxel, 252 per brick), with normals in all
/// directions.
SurfaceChunk RandomChunk(BrickIndex brick, int vertices, std::mt19937& random) {
  SurfaceChunk chunk{.brick = brick};
  const auto [x, y, z] = kLayout.PlaceOf(brick);
  const Vec3 low = kLayout.Node(x * kBrickEdge - 1, y * kBrickEdge - 1, z * kBrickEdge - 1);
  std::uniform_int_distribution<int> place(0, 252), material(0, 127);
  std::normal_distribution<float> along;
  for (int i = 0; i < vertices; ++i) {
    const auto step = [&] { return kLayout.voxel_mm / 28.0F * static_cast<float>(place(random)); };
    const Vec3 n{along(random), along(random), along(random)};
    chunk.vertices.push_back({.p_mm = low + Vec3{step(), step(), step()},
                              .normal = (1.0F / Norm(n)) * n,
                              .material = static_cast<std::uint8_t>(material(random)),
                              .cut = i % 3 == 0});
  }
  for (int i = 0; i < 4 * vertices; ++i) chunk.quads.push_back(static_cast<std::uint16_t>(i % vertices));
  return chunk;
}

TEST(ChunkBytes, ReadsBackWhatWasWritten) {
  std::mt19937 random(1);
  for (const int count : {1, 3, 256, 257, 1000}) {
    const SurfaceChunk sent = RandomChunk(kLayout.Count() / 2, count, random);
    std::vector<std::uint8_t> bytes;
    AppendChunk(kLayout, sent, bytes);
    SurfaceChunk read;
    ASSERT_EQ(ReadChunk(kLayout, bytes, read), bytes.size());
    EXPECT_EQ(read.brick, sent.brick);
    EXPECT_EQ(read.quads, sent.quads);
    ASSERT_EQ(read.vertices.size(), sent.vertices.size());
    for (std::size_t i = 0; i < read.vertices.size(); ++i) {
      const SurfaceVertex &a = sent.vertices[i], &b = read.vertices[i];
      EXPECT_LT(Norm(a.p_mm - b.p_mm), 1e-4F);
      EXPECT_GT(Dot(a.normal, b.normal), 0.9998F);  // 1.2 degrees: two bytes a normal
      EXPECT_EQ(a.material, b.material);
      EXPECT_EQ(a.cut, b.cut);
    }
  }
}

TEST(ChunkBytes, LeavesOutVerticesWithoutAQuad) {
  std::mt19937 random(2);
  SurfaceChunk sent = RandomChunk(0, 8, random);
  sent.quads = {7, 2, 3, 4};
  std::vector<std::uint8_t> bytes;
  AppendChunk(kLayout, sent, bytes);
  EXPECT_EQ(bytes.size(), kChunkHeadBytes + 4 * kVertexBytes + 4);
  SurfaceChunk read;
  ASSERT_TRUE(ReadChunk(kLayout, bytes, read));
  EXPECT_EQ(read.quads, (std::vector<std::uint16_t>{3, 0, 1, 2}));
}

TEST(ChunkBytes, RefusesEveryPrefix) {
  std::mt19937 random(3);
  std::vector<std::uint8_t> bytes;
  AppendChunk(kLayout, RandomChunk(5, 300, random), bytes);
  SurfaceChunk read{.brick = 77};
  for (std::size_t n = 0; n < bytes.size(); ++n)
    ASSERT_FALSE(ReadChunk(kLayout, std::span(bytes).first(n), read)) << n;
  EXPECT_EQ(read.brick, 77U);
}

TEST(ChunkBytes, RefusesNumbersOutOfRange) {
  std::mt19937 random(4);
  std::vector<std::uint8_t> good;
  AppendChunk(kLayout, RandomChunk(5, 10, random), good);
  SurfaceChunk read;
  const auto refused = [&](std::size_t at, std::uint8_t value) {
    std::vector<std::uint8_t> bad = good;
    bad[at] = value;
    return !ReadChunk(kLayout, bad, read);
  };
  EXPECT_TRUE(refused(3, 0x7f));               // the brick's number
  EXPECT_TRUE(refused(kChunkHeadBytes, 253));  // a vertex's place: 252 steps at most
  EXPECT_TRUE(refused(good.size() - 1, 10));   // a quad's vertex: 9 is the last
  EXPECT_TRUE(refused(7, 0xff));               // count of quads
  EXPECT_TRUE(refused(5, 0xff));               // count of vertices
  EXPECT_FALSE(refused(good.size() - 1, 9));
}

TEST(ChunkBytes, RandomBytesNeverLeadOutOfBounds) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> byte(0, 255), size(0, 400);
  for (int trial = 0; trial < 20000; ++trial) {
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size(random)));
    for (auto& b : bytes) b = static_cast<std::uint8_t>(byte(random));
    // small numbers of the brick, vertices and quads, so that some trials are accepted
    if (bytes.size() > 8) bytes[1] = bytes[2] = bytes[3] = bytes[5] = bytes[7] = 0;
    SurfaceChunk read;
    const auto used = ReadChunk(kLayout, bytes, read);
    if (!used) continue;
    ASSERT_LE(*used, bytes.size());
    for (const std::uint16_t v : read.quads) ASSERT_LT(v, read.vertices.size());
  }
}

}  // namespace
}  // namespace osteon::surface
