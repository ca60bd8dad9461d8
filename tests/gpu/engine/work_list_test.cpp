#include "gpu/engine/work_list.h"

#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include <gtest/gtest.h>

// Tests the layout of a tool's balls in groups, and the work list. The list says which tool balls can meet
// which cluster of bone balls.

namespace osteon::gpu {
namespace {

constexpr double kMillimetres = 1e3;

// A tool of balls on a sphere of 20 mm radius. The balls follow a spiral, so neighbours in the list are not
// neighbours in space. Every seventh ball does not cut.
simulation::Tool Spiral(int count) {
  simulation::Tool tool;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / count, r = std::sqrt(1.0 - z * z);
    tool.balls.push_back(
        {.center_m = Vector3(20e-3 * r * std::cos(golden * i), 20e-3 * r * std::sin(golden * i), 20e-3 * z),
         .radius_m = 1e-3 + 1e-5 * (i % 50),
         .cutting = i % 7 != 0});
  }
  return tool;
}

// Clusters of 64 neighbouring bone balls with radii of up to 1 mm, at random places near the tool's sphere.
std::vector<vec4> Clusters(int count) {
  std::mt19937_64 random(3);
  std::normal_distribution<float> direction;
  std::uniform_real_distribution<float> from_center(15.0f, 28.0f), near(-2.0f, 2.0f), radius(0.1f, 1.0f);
  std::vector<vec4> items;
  for (int c = 0; c < count; ++c) {
    Eigen::Vector3f p(direction(random), direction(random), direction(random));
    p *= from_center(random) / p.norm();
    for (uint k = 0; k < kGroupSize; ++k)
      items.push_back({p.x() + near(random), p.y() + near(random), p.z() + near(random), radius(random)});
  }
  return items;
}

// The paths of a tool's groups and balls along motion_m, enlarged by reach_mm.
struct Sweeps {
  std::vector<BallSweep> groups, balls;
};
Sweeps MakeSweeps(const ToolLayout& layout, const Vector3& motion_m, float reach_mm) {
  const auto sweep = [&](const ToolLayout::Item& ball) {
    const Eigen::Vector3f a = (ball.center_T_m * kMillimetres).cast<float>();
    return BallSweep{.a = a,
                     .b = a + (motion_m * kMillimetres).cast<float>(),
                     .radius_mm = static_cast<float>(ball.radius_m * kMillimetres) + reach_mm};
  };
  Sweeps sweeps;
  for (const ToolLayout::Item& bound : layout.group_bounds) sweeps.groups.push_back(sweep(bound));
  for (const ToolLayout::Item& ball : layout.balls) sweeps.balls.push_back(sweep(ball));
  return sweeps;
}

// Smallest distance [mm] between the surfaces of a bone ball and a moving tool ball, sampled along the
// motion.
float Gap(const vec4& ball, const BallSweep& sweep) {
  float min_gap_mm = std::numeric_limits<float>::max();
  for (int i = 0; i <= 50; ++i) {
    const Eigen::Vector3f p = sweep.a + static_cast<float>(i) / 50.0f * (sweep.b - sweep.a);
    min_gap_mm =
        std::min(min_gap_mm, (p - Eigen::Vector3f(ball.x, ball.y, ball.z)).norm() - ball.w - sweep.radius_mm);
  }
  return min_gap_mm;
}

TEST(ToolLayout, EachBallIsInOneGroupOfNeighbours) {
  const ToolLayout layout = LayOutTool(Spiral(1000));
  std::set<uint> seen;
  double widest_m = 0.0;
  for (std::size_t g = 0; g < layout.groups.size(); ++g) {
    EXPECT_LE(layout.groups[g].size(), kToolGroup);
    for (const uint t : layout.groups[g]) {
      EXPECT_TRUE(seen.insert(t).second) << t;
      EXPECT_EQ(layout.group_of[t], g);
      EXPECT_EQ(layout.Cuts(t), layout.Cuts(layout.groups[g].front())) << "one kind";
      const ToolLayout::Item& bound = layout.group_bounds[g];
      EXPECT_LE((layout.balls[t].center_T_m - bound.center_T_m).norm() + layout.balls[t].radius_m,
                bound.radius_m + 1e-12);
    }
    if (layout.Cuts(layout.groups[g].front())) widest_m = std::max(widest_m, layout.group_bounds[g].radius_m);
  }
  EXPECT_EQ(seen.size(), 1000u);
  // 16 of 857 balls on 5000 mm^2 cover a patch of about 10 mm; the patch may be twice as long as wide
  EXPECT_LT(widest_m, 10e-3);
  for (std::size_t t = 1; t < layout.cutter_count; ++t) EXPECT_LT(layout.number[t - 1], layout.number[t]);
}

TEST(WorkList, ListsEveryPairThatCanMeetInOrderAndFewOthers) {
  const std::vector<vec4> items = Clusters(120);
  const ClusterTree tree(items);
  const ToolLayout layout = LayOutTool(Spiral(300));
  const Sweeps sweeps = MakeSweeps(layout, {3e-3, -2e-3, 1e-3}, 0.4f);
  WorkList work(tree.cluster_count(), layout, 100'000);
  std::vector<ClusterPairs> found;
  for (int again = 0; again < 2; ++again) {  // the second pass must leave nothing of the first
    work.Clear();
    work.Add(tree, sweeps.groups, sweeps.balls, found);
  }
  std::set<std::pair<uint, uint>> listed;
  for (const ClusterPairs& item : found)
    for (uint i = 0; i < item.count; ++i) {
      const uint t = work.refs()[item.first + i];
      EXPECT_TRUE(listed.insert({item.cluster, t}).second);
      EXPECT_EQ(i < item.cutters, layout.Cuts(t));
      if (i > 0) {
        EXPECT_LT(work.refs()[item.first + i - 1], t);
      }
    }
  std::size_t meet = 0;
  for (uint c = 0; c < tree.cluster_count(); ++c)
    for (uint t = 0; t < layout.balls.size(); ++t) {
      float gap = std::numeric_limits<float>::max();
      for (uint k = 0; k < kGroupSize; ++k)
        gap = std::min(gap, Gap(items[c * kGroupSize + k], sweeps.balls[t]));
      if (gap > 0.0f) continue;
      ++meet;
      EXPECT_TRUE(listed.contains({c, t})) << "cluster " << c << " and tool ball " << t;
    }
  EXPECT_GT(meet, 200u);
  EXPECT_LT(listed.size(), 2 * meet) << "a box and a ball around the way leave some that do not";
}

TEST(WorkList, ListsAllToolBallsIfThePairsDoNotFit) {
  const ClusterTree tree(Clusters(120));
  const ToolLayout layout = LayOutTool(Spiral(300));
  const Sweeps sweeps = MakeSweeps(layout, Vector3::Zero(), 0.4f);
  WorkList enough(tree.cluster_count(), layout, 100'000);
  std::vector<ClusterPairs> whole, found;
  enough.Add(tree, sweeps.groups, sweeps.balls, whole);
  for (const std::size_t room : {300u, 310u, 500u}) {
    WorkList work(tree.cluster_count(), layout, room);
    work.Add(tree, sweeps.groups, sweeps.balls, found);
    std::set<uint> clusters;
    for (const ClusterPairs& item : found) {
      clusters.insert(item.cluster);
      EXPECT_EQ(item.first, 0u);
      EXPECT_EQ(item.count, 300u);
      EXPECT_EQ(item.cutters, layout.cutter_count);
    }
    for (const ClusterPairs& item : whole) EXPECT_TRUE(clusters.contains(item.cluster)) << item.cluster;
    for (uint t = 0; t < 300; ++t) EXPECT_EQ(work.refs()[t], t);
  }
}

}  // namespace
}  // namespace osteon::gpu
