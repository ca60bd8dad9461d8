#include "simulation/packing/ball_forest.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "base/parallel.h"
#include "simulation/packing/morton.h"

namespace osteon::simulation {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Maximum of values that several threads offer. The final maximum does not depend on the order of the
/// offers.
class SharedMaximum {
 public:
  explicit SharedMaximum(double start) : value_(start) {}
  void Offer(double value) {
    double now = value_.load(std::memory_order_relaxed);
    while (value > now && !value_.compare_exchange_weak(now, value, std::memory_order_relaxed)) {
    }
  }
  [[nodiscard]] double Get() const { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<double> value_;
};

}  // namespace

double BallForest::Node::SquaredDistance(const Vector3& p_m) const {
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double outside = std::max({0.0, low_m[axis] - p_m[axis], p_m[axis] - high_m[axis]});
    sum += outside * outside;
  }
  return sum;
}

BallForest::BallForest(std::span<const Ball> balls) {
  Eigen::AlignedBox3d box;
  std::map<int, std::vector<Ball>, std::greater<>> octaves;
  for (const Ball& ball : balls) {
    box.extend(Vector3(ball.center_m));
    octaves[std::ilogb(ball.radius_m)].push_back(ball);
  }
  for (auto& [octave, members] : octaves) {
    SortAlongMortonCurve(members, box, [](const Ball& ball) { return Vector3(ball.center_m); });
    trees_.push_back(MakeTree(std::move(members)));
  }
}

BallForest::Tree BallForest::MakeTree(std::vector<Ball> balls) {
  Tree tree{.balls = std::move(balls), .levels = {}};
  // a node with an empty box
  const auto empty = [] {
    return Node{.low_m = {kInfinity, kInfinity, kInfinity},
                .high_m = {-kInfinity, -kInfinity, -kInfinity},
                .radius_m = 0.0};
  };
  std::vector<Node>& leaves = tree.levels.emplace_back((tree.balls.size() + kLeaf - 1) / kLeaf, empty());
  for (std::size_t i = 0; i < tree.balls.size(); ++i) {
    Node& leaf = leaves[i / kLeaf];
    const Vector3 c = tree.balls[i].center_m;
    for (int axis = 0; axis < 3; ++axis) {
      leaf.low_m[axis] = std::min(leaf.low_m[axis], c[axis]);
      leaf.high_m[axis] = std::max(leaf.high_m[axis], c[axis]);
    }
    leaf.radius_m = std::max(leaf.radius_m, tree.balls[i].radius_m);
  }
  // build each level from the one below, up to a single root
  while (tree.levels.back().size() > 1) {
    const std::vector<Node>& below = tree.levels.back();
    std::vector<Node> level((below.size() + kArity - 1) / kArity, empty());
    for (std::size_t i = 0; i < below.size(); ++i) {
      Node& node = level[i / kArity];
      for (int axis = 0; axis < 3; ++axis) {
        node.low_m[axis] = std::min(node.low_m[axis], below[i].low_m[axis]);
        node.high_m[axis] = std::max(node.high_m[axis], below[i].high_m[axis]);
      }
      node.radius_m = std::max(node.radius_m, below[i].radius_m);
    }
    tree.levels.push_back(std::move(level));
  }
  return tree;
}

template <typename Limit, typename Visit>
bool BallForest::Search(const Tree& tree, const Vector3& p_m, const Limit& limit, const Visit& visit) {
  // a node that is still to be visited, with its squared distance from p
  struct Open {
    double squared;
    std::size_t level, index;
  };
  // At most kArity - 1 siblings wait on each level, so 64 entries suffice for more balls than fit into
  // memory.
  std::array<Open, 64> stack;
  std::size_t open = 0;
  const auto may_matter = [&limit](const Node& node, double squared) {
    const double reach = limit(node);
    return reach > 0.0 && squared < reach * reach;
  };
  const std::size_t top = tree.levels.size() - 1;
  stack[open++] = {tree.levels[top][0].SquaredDistance(p_m), top, 0};
  while (open > 0) {
    const Open now = stack[--open];
    // test again: the limit may have decreased since this node was pushed
    if (!may_matter(tree.levels[now.level][now.index], now.squared)) continue;
    if (now.level == 0) {
      const std::size_t end = std::min(tree.balls.size(), (now.index + 1) * kLeaf);
      for (std::size_t i = now.index * kLeaf; i < end; ++i)
        if (visit(tree.balls[i], i)) return true;
      continue;
    }
    const std::vector<Node>& below = tree.levels[now.level - 1];
    const std::size_t end = std::min(below.size(), (now.index + 1) * kArity), first = open;
    for (std::size_t i = now.index * kArity; i < end; ++i) {
      const double squared = below[i].SquaredDistance(p_m);
      if (!may_matter(below[i], squared)) continue;
      // insert the node so that the nearest one is on top of the stack
      std::size_t at = open++;
      for (; at > first && stack[at - 1].squared < squared; --at) stack[at] = stack[at - 1];
      stack[at] = {squared, now.level - 1, i};
    }
  }
  return false;
}

double BallForest::Gap(const Vector3& p_m, double at_most_m) const {
  double gap = at_most_m;
  for (const Tree& tree : trees_) {
    const bool covered = Search(
        tree, p_m, [&gap](const Node& node) { return gap + node.radius_m; },
        [&](const Ball& ball, std::size_t) {
          gap = std::min(gap, (p_m - Vector3(ball.center_m)).norm() - ball.radius_m);
          return gap <= 0.0;
        });
    if (covered) return 0.0;
  }
  return gap;
}

double BallForest::MaxOverlap(int threads) const {
  SharedMaximum worst(0.0);
  for (std::size_t t = 0; t < trees_.size(); ++t) {
    const std::vector<Ball>& balls = trees_[t].balls;
    ParallelFor(balls.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Vector3 c = balls[i].center_m;
        const double r = balls[i].radius_m;
        double max_overlap_m = worst.Get();
        // Each pair is searched starting from its smaller ball: many small balls around a large one then cost
        // one descent of a tree each.
        for (std::size_t larger = 0; larger <= t; ++larger)
          Search(
              trees_[larger], c, [&](const Node& node) { return r + node.radius_m - max_overlap_m; },
              [&](const Ball& other, std::size_t j) {
                if (larger < t || j > i)
                  max_overlap_m =
                      std::max(max_overlap_m, r + other.radius_m - (c - Vector3(other.center_m)).norm());
                return false;
              });
        worst.Offer(max_overlap_m);
      }
    });
  }
  return worst.Get();
}

double BallForest::Separation(const Ball& one_of_them) const {
  const Vector3 c = one_of_them.center_m;
  const double r = one_of_them.radius_m;
  double min_ratio = kInfinity;
  bool met_itself = false;
  for (const Tree& tree : trees_)
    Search(
        tree, c, [&](const Node& node) { return min_ratio * std::max(r, node.radius_m); },
        [&](const Ball& other, std::size_t) {
          const double distance = (c - Vector3(other.center_m)).norm();
          if (distance == 0.0 && other.radius_m == r && !met_itself)
            met_itself = true;
          else
            min_ratio = std::min(min_ratio, distance / std::max(r, other.radius_m));
          return false;
        });
  return min_ratio;
}

double BallForest::MaxProtrusion(const Solid& solid, int threads) const {
  SharedMaximum worst(-kInfinity);
  const auto offer = [&](const Ball& ball) {
    worst.Offer(ball.radius_m + solid.SignedDistance(ball.center_m));
  };
  for (const Tree& tree : trees_) {
    // start with about 4096 balls of each tree: the larger the maximum so far, the more boxes are skipped
    // afterwards
    constexpr std::size_t kFirst = 4096;
    const std::size_t stride = std::max<std::size_t>(1, tree.balls.size() / kFirst);
    ParallelFor((tree.balls.size() + stride - 1) / stride, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) offer(tree.balls[i * stride]);
    });
    if (stride == 1) continue;  // all balls of this tree were already offered
    // Descend from a level that has enough nodes for every thread. Which boxes are skipped depends on the
    // threads' order; the maximum does not.
    std::size_t level = tree.levels.size() - 1;
    while (level > 0 && tree.levels[level].size() < 256) --level;
    const auto descend = [&](const auto& self, std::size_t node_level, std::size_t index) -> void {
      const Node& node = tree.levels[node_level][index];
      const Vector3 low(node.low_m.data()), high(node.high_m.data());
      const double distance = solid.SignedDistance(0.5 * (low + high));
      // skip a box so deep inside the solid that none of its balls can protrude more than the maximum so far
      if (distance < 0.0 && distance + 0.5 * (high - low).norm() + node.radius_m <= worst.Get()) return;
      if (node_level > 0) {
        const std::size_t end = std::min(tree.levels[node_level - 1].size(), (index + 1) * kArity);
        for (std::size_t i = index * kArity; i < end; ++i) self(self, node_level - 1, i);
      } else {
        const std::size_t end = std::min(tree.balls.size(), (index + 1) * kLeaf);
        for (std::size_t i = index * kLeaf; i < end; ++i) offer(tree.balls[i]);
      }
    };
    ParallelFor(
        tree.levels[level].size(), threads,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) descend(descend, level, i);
        },
        1);
  }
  return worst.Get();
}

}  // namespace osteon::simulation
