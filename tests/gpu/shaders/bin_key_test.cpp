#include "gpu/shaders/bin_key.h"

#include <cmath>
#include <initializer_list>

#include <gtest/gtest.h>

// Tests the 64-bit keys by which the shaders find the nearest pair of a bin. A key consists of distance
// (score), bone ball and tool ball. This test compiles the shaders' own source as C++.

namespace osteon::gpu {
namespace {

TEST(BinKey, DecodesToItsPartsUpToTheLargestBoneAndTool) {
  for (const uint bits : {kMinBoneBits, 26u, kMaxBoneBits}) {
    const uint last_bone = (1u << bits) - 1u, last_units = (1u << kScoreBits) - 1u;
    for (const uint bone : {0u, 1u, last_bone - 1u, last_bone})
      for (const uint tool : {0u, 1u, kMaxToolBalls - 1u})
        for (const uint units : {0u, 1u, 33554432u, last_units}) {
          const uint64_t key = BinKey(units, bone, tool, bits);
          ASSERT_EQ(BoneOfKey(key, bits), bone) << bits;
          ASSERT_EQ(ToolOfKey(key), tool) << bits;
          ASSERT_EQ(UnitsOfKey(key, bits), KeptUnits(units, bits)) << bits;
          ASSERT_EQ(UnitsOfHalf(static_cast<uint>(key >> 32), bits), KeptUnits(units, bits)) << bits;
        }
  }
}

TEST(BinKey, HasRoomForEveryBallOfTheBone) {
  for (const std::size_t balls : {std::size_t{0}, std::size_t{1}, std::size_t{1} << 24,
                                  (std::size_t{1} << 24) + 1, std::size_t{100'000'000}, kMaxBoneBalls}) {
    EXPECT_GE(std::size_t{1} << BoneBits(balls), balls);
    EXPECT_LE(BoneBits(balls), kMaxBoneBits);
  }
  EXPECT_EQ(BoneBits(std::size_t{1} << 24), 24u) << "no unit is lost before it has to be";
  EXPECT_EQ(BoneBits((std::size_t{1} << 24) + 1), 25u);
}

// The pair with the smaller distance wins; if equal, the one with the lower bone ball; if equal, the one with
// the lower tool ball.
TEST(BinKey, OrdersByScoreThenBallThenToolBall) {
  const auto key = [](double score_mm, uint bone, uint tool) {
    return BinKey(ScoreUnits(score_mm), bone, tool, kMinBoneBits);
  };
  EXPECT_LT(key(-0.01, 9, 9), key(0.0, 1, 1));
  EXPECT_LT(key(0.0, 1, 9), key(0.0, 2, 1));
  EXPECT_LT(key(0.0, 1, 1), key(0.0, 1, 2));
}

// Scores keep their order for every depth at which a tool may be placed, and up to the largest enlargement
// that a cell may have. Beyond about 33 mm they saturate.
TEST(BinKey, DistinguishesScoresBeyondAMillimetre) {
  const double step_mm = 1e-4;
  for (const double score : {-30.0, -5.0, -1.5, -0.97, -0.96, -0.1, 0.0, 0.24, 0.96, 0.97, 1.5, 5.0, 30.0})
    EXPECT_LT(ScoreUnits(score), ScoreUnits(score + step_mm)) << score;
  EXPECT_EQ(ScoreUnits(-40.0), ScoreUnits(-1e9));
  EXPECT_EQ(ScoreUnits(40.0), ScoreUnits(1e9));
  EXPECT_LT(BinKey(ScoreUnits(1e9), (1u << kMaxBoneBits) - 1u, kMaxToolBalls, kMaxBoneBits), ~uint64_t{0})
      << "all ones are no pair";
}

TEST(BinKey, RisesWithTheScoreInFloatsAndInDoubles) {
  uint last = 0, last_of_floats = 0;
  for (double score = -34.0; score < 34.0; score += 1.0 / 4096.0) {
    const uint units = ScoreUnits(score), of_floats = ScoreUnits(static_cast<float>(score));
    ASSERT_GE(units, last) << score;
    ASSERT_GE(of_floats, last_of_floats) << score;
    ASSERT_EQ(units, of_floats) << "a score that floats hold: " << score;
    last = units;
    last_of_floats = of_floats;
  }
}

TEST(BinKey, ResolvesScoresInUnitsOf30Picometres) {
  // scores are counted in units of 2^-25 mm
  EXPECT_EQ(ScoreUnits(1e-7) - ScoreUnits(0.0), static_cast<uint>(1e-7 * 33554432.0));
  EXPECT_EQ(ScoreUnits(0.24) - ScoreUnits(0.0), static_cast<uint>(0.24 * 33554432.0));
}

}  // namespace
}  // namespace osteon::gpu
