#include "simulation/removal/split_template.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "base/parallel.h"
#include "base/scramble.h"
#include "simulation/packing/ball_forest.h"

namespace osteon::simulation {
namespace {

// Largest distance of a child's centre from its parent's, in radii of the parent, as all lengths here. With a
// smaller value, a cut removes more bone; with a larger one, it leaves gaps at the rim.
constexpr double kReach = 0.6;
// Radius of the small children of an exposed ball, and the largest angle between the pole and their centres.
constexpr double kCapRadius = 0.25, kCapAngle = 35.0 / 180.0 * std::numbers::pi;
const double kGoldenAngle = std::numbers::pi * (3.0 - std::sqrt(5.0));

/// Point i of n points that are spread evenly over the unit sphere's cap z >= lowest, along a spiral from the
/// pole.
Vector3 OnSpiral(std::uint32_t i, std::uint32_t n, double lowest) {
  const double z = 1.0 - (1.0 - lowest) * (i + 0.5) / n, ring_radius = std::sqrt(1.0 - z * z);
  return {ring_radius * std::cos(kGoldenAngle * i), ring_radius * std::sin(kGoldenAngle * i), z};
}

/// The points of a cubic lattice in a ball about the origin: about `count` points.
std::vector<Vector3> LatticeInBall(double radius, double count) {
  const double side = radius * std::cbrt(4.0 / 3.0 * std::numbers::pi / count);
  const int n = static_cast<int>(std::ceil(radius / side)) + 1;
  std::vector<Vector3> points;
  for (int k = -n; k <= n; ++k)
    for (int j = -n; j <= n; ++j)
      for (int i = -n; i <= n; ++i) {
        const Vector3 p = side * Vector3(i + 0.31, j + 0.17, k + 0.43);  // the offset avoids every symmetry
        if (p.norm() <= radius) points.push_back(p);
      }
  return points;
}

/// Spreads `count` centres in a ball by Lloyd's relaxation from random places: in each round, a centre moves
/// to the mean of the lattice points that are nearer to it than to any other centre.
std::vector<Vector3> SpreadInBall(int count, double radius) {
  const std::vector<Vector3> space = LatticeInBall(radius, 60.0 * count);
  std::vector<Vector3> centers;
  std::uint64_t state = 2024;
  while (centers.size() < static_cast<std::size_t>(count)) {
    Vector3 p;
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = radius * (2.0 * Uniform(MixBits(state += kSplitMixStep)) - 1.0);
    if (p.norm() <= radius) centers.push_back(p);
  }
  constexpr int kRounds = 40;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Vector3> sum(centers.size(), Vector3::Zero());
    std::vector<int> members(centers.size(), 0);
    for (const Vector3& p : space) {
      std::size_t nearest = 0;
      for (std::size_t i = 1; i < centers.size(); ++i)
        if ((p - centers[i]).squaredNorm() < (p - centers[nearest]).squaredNorm()) nearest = i;
      sum[nearest] += p;
      ++members[nearest];
    }
    for (std::size_t i = 0; i < centers.size(); ++i)
      if (members[i] > 0) centers[i] = sum[i] / members[i];
  }
  return centers;
}

/// Uniformly distributed rotation: Shoemake, Uniform Random Rotations, Graphics Gems III, 1992.
Matrix3 RandomRotation(std::uint32_t index) {
  std::uint64_t state = index;
  const double u = Uniform(MixBits(state += kSplitMixStep)), v = Uniform(MixBits(state += kSplitMixStep)),
               w = Uniform(MixBits(state += kSplitMixStep));
  const double turn = 2.0 * std::numbers::pi;
  return Eigen::Quaterniond(std::sqrt(u) * std::cos(turn * w), std::sqrt(1.0 - u) * std::sin(turn * v),
                            std::sqrt(1.0 - u) * std::cos(turn * v), std::sqrt(u) * std::sin(turn * w))
      .toRotationMatrix();
}

/// Direction of pole i of an exposed ball.
Vector3 Pole(std::uint32_t i) { return OnSpiral(i, SplitTemplate::kPoles, -1.0); }

/// The value rounded to single precision.
double ToFloat(double value) { return static_cast<double>(static_cast<float>(value)); }

/// The child at x: as large as fits into the unit ball, up to `largest`.
SplitChild Child(const Vector3& x, double largest) {
  SplitChild child{.x = Vector3(ToFloat(x.x()), ToFloat(x.y()), ToFloat(x.z()))};
  child.radius = ToFloat(std::min(largest, 1.0 - child.x.norm()) * (1.0 - 1e-6));
  return child;
}

}  // namespace

SplitTemplate::SplitTemplate(int children) : children_(children) {
  if (children < 8 || children > 1024)
    throw std::invalid_argument(fmt::format("split: children: found {}, accepted 8 … 1024", children));
  const int small = 3 * children / 8;
  const std::vector<Vector3> buried_centers = SpreadInBall(children, kReach),
                             exposed_centers = SpreadInBall(children - small, kReach);
  table_.reserve(kShapes * buried_centers.size());
  for (std::uint32_t rotation = 0; rotation < kRotations; ++rotation) {
    const Matrix3 R = RandomRotation(rotation);
    for (const Vector3& x : buried_centers) table_.push_back(Child(R * x, 1.0));
  }
  for (std::uint32_t pole = 0; pole < kPoles; ++pole) {
    const Matrix3 R = RotationFromZTo(Pole(pole)) *
                      Eigen::AngleAxisd(kGoldenAngle * pole, Vector3::UnitZ()).toRotationMatrix();
    const auto n = static_cast<std::uint32_t>(small);
    for (std::uint32_t i = 0; i < n; ++i)
      table_.push_back(Child((1.0 - kCapRadius) * (R * OnSpiral(i, n, std::cos(kCapAngle))), kCapRadius));
    for (const Vector3& x : exposed_centers) table_.push_back(Child(R * x, 1.0));
  }
}

std::vector<std::uint16_t> SplitShapes(std::span<const Ball> balls, double min_radius_m, int threads) {
  constexpr std::uint32_t kDirections = 48;
  constexpr double kJustOutside = 1.001,
                   // radius of the tested points, over the ball's; gap below which balls touch
      kTouch_m = 1e-9;
  // if the mean of the uncovered directions is shorter than this, there is no single exposed side
  constexpr double kOneSided = 0.3;
  std::vector<Ball> solid;
  std::copy_if(balls.begin(), balls.end(), std::back_inserter(solid),
               [](const Ball& b) { return b.radius_m > 0.0; });
  const BallForest forest(solid);
  std::vector<std::uint16_t> shapes(balls.size());
  ParallelFor(balls.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      // default shape: a rotation that follows from the ball's index by Fibonacci hashing (the upper six of
      // 32 bits)
      std::uint32_t shape = (static_cast<std::uint32_t>(i) * 2654435761u) >> 26;
      Vector3 bare_sum = Vector3::Zero();
      int count = 0;
      for (std::uint32_t k = 0; k < kDirections && balls[i].radius_m > min_radius_m; ++k) {
        const Vector3 d = OnSpiral(k, kDirections, -1.0);
        const Vector3 p = Vector3(balls[i].center_m) + kJustOutside * balls[i].radius_m * d;
        if (forest.Gap(p, kTouch_m) <= 0.0) continue;
        bare_sum += d;
        ++count;
      }
      if (count > 0 && bare_sum.norm() > kOneSided * count) {
        std::uint32_t nearest = 0;
        for (std::uint32_t pole = 1; pole < SplitTemplate::kPoles; ++pole)
          if (Pole(pole).dot(bare_sum) > Pole(nearest).dot(bare_sum)) nearest = pole;
        shape = SplitTemplate::kRotations + nearest;
      }
      shapes[i] = static_cast<std::uint16_t>(shape);
    }
  });
  return shapes;
}

}  // namespace osteon::simulation
