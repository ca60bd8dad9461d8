#include "simulation/removal/ball_removal.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "simulation/contact/cutting_math.h"
#include "simulation/fidelity/carved_shape.h"
#include "simulation/removal/cut_metrics.h"

// Tests of the removal of swept capsules from a packing, and of the splitting of balls. A "block" is the room
// for the children of one split ball.

namespace osteon::simulation {
namespace {

using Balls = std::vector<BallState>;

/// Overlapping balls on a cubic lattice; `n` along each axis.
Balls Lattice(int n, double spacing_m = 2e-3, double radius_m = 1.8e-3) {
  Balls balls;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        balls.push_back({.center_m = spacing_m * (Vector3(i, j, k) - Vector3::Constant(0.5 * (n - 1))),
                         .radius_m = radius_m});
  return balls;
}

SplitParams Split() { return {.on = true, .children = 24}; }

/// Path of a cutter that starts above the lattice and wanders into it at random: consecutive capsules of this
/// radius.
std::vector<Capsule> RandomPath(std::uint64_t seed, int count, double radius_m, double reach_m = 5e-3) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Capsule> capsules;
  Vector3 at(0, 0, 12e-3);
  for (int i = 0; i < count; ++i) {
    const Vector3 to = at + 0.3 * (reach_m * Vector3(uniform(random), uniform(random), uniform(random)) - at);
    capsules.push_back({.a = at, .b = to, .radius_m = radius_m});
    at = to;
  }
  return capsules;
}

/// The balls that remain.
std::vector<Ball> Live(const Balls& balls) {
  std::vector<Ball> live;
  for (const BallState& b : balls)
    if (b.radius_m > 0.0) live.push_back({.center_m = b.center_m, .radius_m = b.radius_m});
  return live;
}

/// Largest depth of a remaining ball in a capsule; -1 if no ball remains.
double WorstOverlap(const Balls& balls, const std::vector<Capsule>& capsules) {
  double worst = -1.0;
  for (const BallState& ball : balls)
    for (const Capsule& c : capsules)
      if (ball.radius_m > 0.0)
        worst = std::max(worst, ball.radius_m + c.radius_m -
                                    (ball.center_m - ClosestOnSegment(ball.center_m, c.a, c.b)).norm());
  return worst;
}

/// The state that the removal saves.
CarvedState StateOf(const BallRemoval& removal, const Balls& balls) {
  CarvedState state;
  removal.Save(balls, state);
  return state;
}

bool Same(const CarvedState& a, const CarvedState& b) {
  return a.balls == b.balls && a.split_balls == b.split_balls && a.split_cuts == b.split_cuts &&
         a.split_slots == b.split_slots;
}

TEST(BallRemoval, LeavesNothingInAnyCapsuleAndNeverAddsBone) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    Balls balls = Lattice(6);
    const Balls parents = balls;
    BallRemoval removal(balls, Split());
    const std::vector<Capsule> capsules = RandomPath(seed, 40, 2.5e-3);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-7e-3, 7e-3);
    std::vector<Vector3> places(4000);
    for (Vector3& p : places) p = Vector3(uniform(random), uniform(random), uniform(random));
    std::vector<bool> bone(places.size());
    const BallUnion uncut(Live(balls));
    for (std::size_t k = 0; k < places.size(); ++k) bone[k] = uncut.Distance(places[k], 1e-9) == 0.0;
    std::size_t lost = 0;
    for (std::size_t i = 0; i < capsules.size(); ++i) {
      removal.Remove({&capsules[i], 1}, balls);
      const BallUnion shape(Live(balls));
      for (std::size_t k = 0; k < places.size(); ++k) {
        const bool now = shape.Distance(places[k], 1e-9) == 0.0;
        if (bone[k] && !now) ++lost;
        ASSERT_FALSE(now && !bone[k]) << seed << " " << i << " " << k;
        bone[k] = now;
      }
    }
    EXPECT_GT(lost, 100u);
    EXPECT_LT(WorstOverlap(balls, capsules), 1e-12);
    EXPECT_GT(removal.max_blocks_in_use(), 20u);
    EXPECT_EQ(removal.refused(), 0u);
    // every remaining ball lies in one of the uncut balls
    for (std::size_t i = 0; i < balls.size(); ++i) {
      if (balls[i].radius_m <= 0.0) continue;
      double out = 1.0;
      for (const BallState& parent : parents)
        out =
            std::min(out, (balls[i].center_m - parent.center_m).norm() + balls[i].radius_m - parent.radius_m);
      ASSERT_LE(out, 1e-12) << i;
    }
  }
}

TEST(BallRemoval, WithoutSplittingFollowsThePapersRule) {
  Balls balls = Lattice(3), plain = balls;
  BallRemoval removal(balls, {});
  const std::vector<Capsule> capsules = RandomPath(4, 10, 2e-3);
  removal.Remove(capsules, balls);
  ASSERT_EQ(balls.size(), plain.size());
  for (std::size_t i = 0; i < plain.size(); ++i) {
    for (const Capsule& c : capsules) ShrinkBall(plain[i].center_m, plain[i].radius_m, c.a, c.b, c.radius_m);
    EXPECT_EQ(balls[i].radius_m, plain[i].radius_m);
    EXPECT_EQ((balls[i].center_m - plain[i].center_m).norm(), 0.0);
  }
}

TEST(BallRemoval, SplitsOnlyLargeBallsAndOnceAtTheirFirstTouch) {
  Balls balls{{.center_m = Vector3(0, 0, 0), .radius_m = 2e-3},
              {.center_m = Vector3(10e-3, 0, 0), .radius_m = 0.3e-3}};
  BallRemoval removal(balls, Split());
  const Capsule near{.a = {0, 0, 5e-3}, .b = {0, 0, 4e-3}, .radius_m = 1.9e-3};
  removal.Remove({&near, 1}, balls);
  EXPECT_EQ(removal.blocks_in_use(), 0u);  // the capsule ends 0.1 mm away
  const std::vector<Capsule> touch{{.a = {0, 0, 5e-3}, .b = {0, 0, 3.8e-3}, .radius_m = 1.9e-3},
                                   {.a = {10e-3, 0, 5e-3}, .b = {10e-3, 0, 2.1e-3}, .radius_m = 1.9e-3}};
  removal.Remove(touch, balls);
  EXPECT_EQ(removal.blocks_in_use(), 1u);
  EXPECT_EQ(balls[0].radius_m, 0.0);
  EXPECT_NEAR(balls[1].radius_m, 0.25e-3, 1e-12);
  const Balls once = balls;
  removal.Remove(touch, balls);  // this space is already swept: nothing changes, except by rounding
  ASSERT_EQ(balls.size(), once.size());
  for (std::size_t i = 0; i < balls.size(); ++i) ASSERT_NEAR(balls[i].radius_m, once[i].radius_m, 1e-15);
  // a ball that is removed as a whole takes no block
  Balls alone{{.center_m = Vector3(0, 0, 0), .radius_m = 2e-3}};
  BallRemoval other(alone, Split());
  const Capsule all{.a = {0, 0, 5e-3}, .b = {0, 0, 0}, .radius_m = 3e-3};
  other.Remove({&all, 1}, alone);
  EXPECT_EQ(other.max_blocks_in_use(), 0u);
  EXPECT_EQ(alone[0].radius_m, 0.0);
}

// The pool has a single block. A frame clears the children of the first ball and touches the second, which
// must wait for the next frame to be split.
TEST(BallRemoval, BlocksOfClearedBallsAreReusedFromTheNextFrameOn) {
  Balls balls{{.center_m = Vector3(0, 0, 0), .radius_m = 2e-3},
              {.center_m = Vector3(20e-3, 0, 0), .radius_m = 2e-3}};
  SplitParams params = Split();
  params.pool_blocks = 1;
  BallRemoval removal(balls, params);
  const Capsule touch{.a = {0, 0, 9e-3}, .b = {0, 0, 4e-3}, .radius_m = 2.5e-3};
  removal.Remove({&touch, 1}, balls);
  ASSERT_EQ(removal.blocks_in_use(), 1u);
  const Capsule clear_first{.a = {0, 0, 9e-3}, .b = {0, 0, 0}, .radius_m = 2.5e-3};
  const Capsule touch_second{.a = {20e-3, 0, 9e-3}, .b = {20e-3, 0, 4.4e-3}, .radius_m = 2.5e-3};
  const std::vector<Capsule> both{clear_first, touch_second};
  removal.Remove(both, balls);
  EXPECT_EQ(removal.refused(), 1u);  // the block becomes free only after the frame
  EXPECT_NEAR(balls[1].radius_m, 1.95e-3, 1e-12);
  EXPECT_EQ(removal.blocks_in_use(), 0u);
  const Capsule deeper{.a = {20e-3, 0, 9e-3}, .b = {20e-3, 0, 4e-3}, .radius_m = 2.5e-3};
  removal.Remove({&deeper, 1}, balls);
  EXPECT_EQ(removal.refused(), 1u);
  EXPECT_EQ(removal.blocks_in_use(), 1u);
  EXPECT_EQ(removal.max_blocks_in_use(), 1u);
  // this ball was cut before it was split: its children must lie in what was left of it
  for (std::size_t i = 2; i < balls.size(); ++i) {
    if (balls[i].radius_m > 0.0) {
      EXPECT_LE((balls[i].center_m - Vector3(20e-3, 0, -0.05e-3)).norm() + balls[i].radius_m,
                1.95e-3 + 1e-12);
    }
  }
}

TEST(BallRemoval, AnExhaustedPoolSplitsTheFirstBallsAndCountsTheOthers) {
  const std::vector<Capsule> capsules = RandomPath(7, 30, 2.5e-3);
  Balls balls = Lattice(6);
  SplitParams params = Split();
  params.pool_blocks = 5;
  BallRemoval removal(balls, params);
  removal.Remove(capsules, balls);
  EXPECT_GT(removal.refused(), 10u);
  EXPECT_EQ(removal.blocks_in_use(), 5u);
  EXPECT_LT(WorstOverlap(balls, capsules), 1e-12);
  // the five split balls must be the first five that an unlimited pool would split
  Balls all = Lattice(6);
  BallRemoval free(all, Split());
  free.Remove(capsules, all);
  const std::vector<std::uint32_t> few = StateOf(removal, balls).split_balls,
                                   many = StateOf(free, all).split_balls;
  ASSERT_EQ(few.size(), 5u);
  EXPECT_TRUE(std::equal(few.begin(), few.end(), many.begin()));
}

// If the tool touches the balls in another order, their children get other block numbers. The saved state
// must be the same.
TEST(BallRemoval, ASavedStateDoesNotDependOnBlockNumbers) {
  const auto touch = [](double x, double down) {
    return Capsule{.a = {x, 0, 9e-3}, .b = {x, 0, 4e-3 - down}, .radius_m = 2.2e-3};
  };
  std::vector<CarvedState> states;
  for (const bool backwards : {false, true}) {
    Balls balls;
    for (int i = 0; i < 5; ++i) balls.push_back({.center_m = Vector3(20e-3 * i, 0, 0), .radius_m = 2e-3});
    BallRemoval removal(balls, Split());
    for (int k = 0; k < 5; ++k) {
      const Capsule one = touch(20e-3 * (backwards ? 4 - k : k), 0.0);
      removal.Remove({&one, 1}, balls);
    }
    const std::vector<Capsule> deeper{touch(0, 5e-3), touch(40e-3, 1e-3),
                                      touch(80e-3, 2e-3)};  // the first capsule clears its ball
    removal.Remove(deeper, balls);
    states.push_back(StateOf(removal, balls));
    const std::uint32_t child = backwards ? 5 + 24 * 3 + 7 : 5 + 24 * 1 + 7;  // child 7 of the second ball
    EXPECT_EQ(removal.SavedIndex(child), 5u + 7u);
    EXPECT_EQ(removal.SavedIndex(3), 3u);
    EXPECT_EQ(removal.SavedIndex(backwards ? 5 + 24 * 4 : 5), std::nullopt);  // child of the cleared ball
  }
  EXPECT_TRUE(Same(states[0], states[1]));
  EXPECT_EQ(HashState(states[0]), HashState(states[1]));
  EXPECT_EQ(states[0].split_balls, (std::vector<std::uint32_t>{1, 2, 3, 4}));
}

// Budgets of 1, 2 and 100 splits a frame give the same split balls as no budget (0), and nearly as many
// remaining balls.
TEST(BallRemoval, ABudgetForEachFrameOnlyDelaysSplitting) {
  std::vector<CarvedState> states;
  std::vector<std::size_t> live;
  for (const std::size_t budget : {0, 1, 2, 100}) {
    Balls balls = Lattice(6);
    SplitParams params = Split();
    params.blocks_per_frame = budget;
    BallRemoval removal(balls, params);
    std::vector<Capsule> plunge;  // straight, so that a waiting ball can merge its capsules into one
    for (int i = 0; i < 40; ++i)
      plunge.push_back({.a = Vector3(0.3e-3, 0.2e-3, 12e-3 - 0.25e-3 * i),
                        .b = Vector3(0.3e-3, 0.2e-3, 11.75e-3 - 0.25e-3 * i),
                        .radius_m = 3e-3});
    bool waited = false;
    for (const Capsule& one : plunge) {
      removal.Remove({&one, 1}, balls);
      ASSERT_LT(WorstOverlap(balls, {plunge.front(), one}), 1e-12);
      const auto cuts = StateOf(removal, balls).split_cuts;
      waited = waited || std::ranges::any_of(cuts, [](std::uint32_t n) { return n > 0; });
    }
    EXPECT_EQ(waited, budget == 1 || budget == 2);
    for (int i = 0; i < 200; ++i) removal.Remove({}, balls);
    EXPECT_LT(WorstOverlap(balls, plunge), 2e-8);  // the error of a merged capsule is at most this
    states.push_back(StateOf(removal, balls));
    live.push_back(Live(balls).size());
    EXPECT_EQ(LiveBalls(states.back()).size(), live.back());
  }
  for (std::size_t i = 1; i < states.size(); ++i) {
    EXPECT_EQ(states[i].split_balls, states[0].split_balls);
    EXPECT_EQ(states[i].split_cuts, states[0].split_cuts);
    // many small steps move a ball along a slightly different path than one long capsule, by thousandths of a
    // millimetre
    EXPECT_NEAR(static_cast<double>(live[i]), static_cast<double>(live[0]),
                0.05 * static_cast<double>(live[0]));
  }
}

// The tool has 60 balls, so the block of a waiting ball has no room for all capsules that hit the ball.
// Nothing may remain in the sweep nevertheless.
TEST(BallRemoval, WaitingBallsAreCutRightWhenTheirCapsuleListIsFull) {
  Balls balls = Lattice(5);
  SplitParams params = Split();
  params.blocks_per_frame = 1;
  BallRemoval removal(balls, params);
  std::vector<Capsule> all;
  for (int frame = 0; frame < 20; ++frame) {
    std::vector<Capsule> capsules;
    for (int t = 0; t < 60; ++t) {
      const double angle = 0.7 * t, across = 2e-3 * std::sqrt(t / 60.0);
      const Vector3 off(across * std::cos(angle), across * std::sin(angle), 0.02e-3 * t);
      capsules.push_back({.a = Vector3(0, 0, 9e-3 - 0.3e-3 * frame) + off,
                          .b = Vector3(0.05e-3, 0, 8.7e-3 - 0.3e-3 * frame) + off,
                          .radius_m = 0.5e-3 + 0.01e-3 * t});
    }
    removal.Remove(capsules, balls);
    all.insert(all.end(), capsules.begin(), capsules.end());
    ASSERT_LT(WorstOverlap(balls, all), 2e-8) << frame;
  }
  for (int i = 0; i < 100; ++i) removal.Remove({}, balls);
  EXPECT_LT(WorstOverlap(balls, all), 2e-8);
  EXPECT_GT(removal.blocks_in_use(), 10u);
}

TEST(BallRemoval, ASecondSmallerToolCutsTheChildrenThatTheFirstLeft) {
  Balls balls = Lattice(6);
  BallRemoval removal(balls, Split());
  std::vector<Capsule> all = RandomPath(11, 20, 3e-3);
  removal.Remove(all, balls);
  const std::size_t blocks = removal.blocks_in_use();
  Balls before = balls;
  for (const Capsule& c : RandomPath(12, 60, 0.8e-3, 8e-3)) {
    removal.Remove({&c, 1}, balls);
    all.push_back(c);
  }
  EXPECT_LT(WorstOverlap(balls, all), 1e-12);
  EXPECT_GT(removal.blocks_in_use(),
            blocks);  // the second tool also splits balls that the first did not touch
  // every remaining ball lies in a ball that the first tool left
  for (const Ball& ball : Live(balls)) {
    double out = 1.0;
    for (const Ball& old : Live(before))
      out = std::min(out,
                     (Vector3(ball.center_m) - Vector3(old.center_m)).norm() + ball.radius_m - old.radius_m);
    ASSERT_LE(out, 1e-12);
  }
}

TEST(BallRemoval, ContinuesFromALoadedStateBitForBit) {
  const std::vector<Capsule> capsules = RandomPath(5, 60, 2.2e-3);
  SplitParams params = Split();
  params.blocks_per_frame = 2;  // so that some balls wait
  Balls one = Lattice(6), two = Lattice(6);
  BallRemoval first(one, params), second(two, params);
  for (std::size_t i = 0; i < 12; ++i) first.Remove({&capsules[i], 1}, one);
  const CarvedState middle = StateOf(first, one);
  ASSERT_TRUE(std::ranges::any_of(middle.split_cuts, [](std::uint32_t n) { return n > 1; }));
  ASSERT_TRUE(std::ranges::any_of(middle.split_cuts, [](std::uint32_t n) { return n == 0; }));
  for (std::size_t i = 30; i < 60; ++i) second.Remove({&capsules[i], 1}, two);  // a different history
  first.Load(middle, one);
  second.Load(middle, two);
  EXPECT_TRUE(Same(StateOf(first, one), middle));
  for (std::size_t i = 12; i < 60; ++i) {
    first.Remove({&capsules[i], 1}, one);
    second.Remove({&capsules[i], 1}, two);
  }
  EXPECT_TRUE(Same(StateOf(first, one), StateOf(second, two)));
}

TEST(BallRemoval, RefusesInconsistentStatesAndInvalidParameters) {
  Balls balls = Lattice(3);
  BallRemoval removal(balls, Split());
  removal.Remove(RandomPath(1, 20, 2.5e-3), balls);
  const CarvedState good = StateOf(removal, balls);
  ASSERT_GT(good.split_balls.size(), 3u);
  const auto refused = [&](auto&& spoil) {
    CarvedState state = good;
    spoil(state);
    EXPECT_THROW(removal.Load(state, balls), std::invalid_argument);
  };
  refused([](CarvedState& s) { s.balls.pop_back(); });
  refused([](CarvedState& s) { s.split_cuts.pop_back(); });
  refused([](CarvedState& s) { s.split_slots.pop_back(); });
  refused([](CarvedState& s) { s.split_balls[0] = 27; });
  refused([](CarvedState& s) { s.split_balls[1] = s.split_balls[0]; });
  refused([](CarvedState& s) { s.split_cuts[0] = 13; });
  removal.Load(good, balls);
  EXPECT_TRUE(Same(StateOf(removal, balls), good));
  BallRemoval plain(Lattice(3), {});
  EXPECT_THROW(plain.Load(good, balls), std::invalid_argument);
  const auto bad = [&](SplitParams params) {
    params.on = true;
    EXPECT_THROW(BallRemoval(balls, params), std::invalid_argument);
  };
  bad({.min_radius_m = -1e-3});
  bad({.min_radius_m = std::nan("")});
  bad({.children = 7});
  bad({.min_child_share = 0.6});
  bad({.pool_blocks = 0});
}

}  // namespace
}  // namespace osteon::simulation
