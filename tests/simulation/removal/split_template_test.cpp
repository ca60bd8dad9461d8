#include "simulation/removal/split_template.h"

#include <cmath>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "simulation/fidelity/carved_shape.h"
#include "simulation/packing/split_packing.h"
#include "simulation/solids/box_solid.h"

// Tests of the children that replace a split ball, of the choice of their shape, and of the packing that is
// made to be split.

namespace osteon::simulation {
namespace {

TEST(SplitTemplate, ChildrenLieInTheirParentEvenInSinglePrecision) {
  for (const int children : {8, 24, 96}) {
    const SplitTemplate shapes(children);
    for (std::uint32_t shape = 0; shape < SplitTemplate::kShapes; ++shape)
      for (int k = 0; k < children; ++k) {
        const SplitChild& child = shapes.child(shape, k);
        ASSERT_GT(child.radius, 0.05) << shape << " " << k;
        ASSERT_LT(child.x.norm() + child.radius, 1.0) << shape << " " << k;
        // a parent of 3 mm, 30 mm from the origin; floats resolve 5e-6 mm there
        const Eigen::Vector3f c(17.0f, -17.0f, 17.0f);
        const Eigen::Vector3f at = c + 3.0f * child.x.cast<float>();
        ASSERT_LT((at - c).norm() + 3.0f * static_cast<float>(child.radius), 3.0f + 5e-6f);
        ASSERT_EQ(child.radius, static_cast<double>(static_cast<float>(child.radius)));
      }
  }
}

// A split parent's neighbours may be split too, so its own children must cover its middle, up to 0.8 of its
// radius. The test counts uncovered points for shapes with a rotation and for shapes with a pole.
TEST(SplitTemplate, ChildrenCoverTheMiddleOfTheirParent) {
  const SplitTemplate shapes(24);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int asked = 0, bare_rotation = 0, bare_pole = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Vector3 p(uniform(random), uniform(random), uniform(random));
    if (p.norm() > 0.8) continue;
    ++asked;
    const auto covered = [&](std::uint32_t shape) {
      for (int k = 0; k < shapes.children(); ++k)
        if ((p - shapes.child(shape, k).x).norm() < shapes.child(shape, k).radius) return true;
      return false;
    };
    if (!covered(static_cast<std::uint32_t>(i) % SplitTemplate::kRotations)) ++bare_rotation;
    if (!covered(SplitTemplate::kRotations + static_cast<std::uint32_t>(i) % SplitTemplate::kPoles))
      ++bare_pole;
  }
  EXPECT_GT(asked, 5000);
  EXPECT_EQ(bare_rotation, 0);
  EXPECT_LT(bare_pole, 0.002 * asked);  // fewer large children than with a rotation
}

TEST(SplitTemplate, EachShapeHasADifferentFirstChild) {
  const SplitTemplate shapes(16);
  std::set<std::array<double, 3>> first;
  for (std::uint32_t shape = 0; shape < SplitTemplate::kShapes; ++shape) {
    const Vector3& x = shapes.child(shape, 0).x;
    first.insert({x.x(), x.y(), x.z()});
  }
  EXPECT_EQ(first.size(), SplitTemplate::kShapes);
  EXPECT_THROW(SplitTemplate(7), std::invalid_argument);
  EXPECT_THROW(SplitTemplate(1025), std::invalid_argument);
}

TEST(SplitShapes, ExposedBallsHaveOutwardPolesAndBuriedBallsHaveNone) {
  const BoxSolid box({-6e-3, -6e-3, -12e-3}, {6e-3, 6e-3, 0.0});
  const std::vector<Ball> balls = BuildSplitPacking(box, EverywhereZone(), {.surface_gap_m = 0.1e-3});
  const std::vector<std::uint16_t> shapes = SplitShapes(balls, 0.0, 1);
  EXPECT_EQ(shapes, SplitShapes(balls, 0.0, 3));
  const SplitTemplate table(32);
  int top = 0, buried = 0;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    ASSERT_LT(shapes[i], SplitTemplate::kShapes);
    const Vector3 c = balls[i].center_m;
    const double depth = -box.SignedDistance(c), sides = 6e-3 - std::max(std::abs(c.x()), std::abs(c.y()));
    if (depth > balls[i].radius_m + 1e-3) {
      ASSERT_LT(shapes[i], SplitTemplate::kRotations) << i;
      ++buried;
    }
    if (c.z() < -balls[i].radius_m - 1e-9 || sides < 2e-3) continue;
    // this ball touches the top face away from the edges: its shape must have a pole, and the pole must point
    // up
    ASSERT_GE(shapes[i], SplitTemplate::kRotations) << i;
    EXPECT_GT(table.child(shapes[i], 0).x.normalized().z(), std::cos(20.0 * M_PI / 180.0)) << i;
    ++top;
  }
  EXPECT_GT(top, 10);
  EXPECT_GT(buried, 10);
}

TEST(SplitPacking, StaysInTheSolidAndKeepsItsGapsSmall) {
  const BoxSolid box({-6e-3, -6e-3, -12e-3}, {6e-3, 6e-3, 0.0});
  const SplitPackingParams params;
  const std::vector<Ball> balls = BuildSplitPacking(box, EverywhereZone(), params);
  for (const Ball& ball : balls) ASSERT_LE(ball.radius_m + box.SignedDistance(ball.center_m), 1e-12);
  const BallUnion shape(balls);
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  double worst_inside = 0.0, worst_top = 0.0;
  for (int i = 0; i < 20'000; ++i) {
    const Vector3 p(4.5e-3 * uniform(random), 4.5e-3 * uniform(random), -6e-3 + 4.5e-3 * uniform(random));
    worst_inside = std::max(worst_inside, shape.Distance(p, 1.0));
    worst_top = std::max(worst_top, shape.Distance({p.x(), p.y(), 0.0}, 1.0));
  }
  // samples lie 0.3 mm apart; a gap between them may be larger
  EXPECT_LT(worst_top, 1.5 * params.surface_gap_m);
  EXPECT_LT(worst_inside, 0.2e-3);
  EXPECT_THROW((void)BuildSplitPacking(box, EverywhereZone(), {.radius_over_spacing = 0.5}),
               std::invalid_argument);
  EXPECT_THROW((void)BuildSplitPacking(box, EverywhereZone(), {.surface_gap_m = 0.0}), std::invalid_argument);
  EXPECT_THROW((void)BuildSplitPacking(box, EverywhereZone(), {.fine_depth_m = -1e-3}),
               std::invalid_argument);
}

// Below a surface that will be cut, balls may become larger only beyond the cut's depth.
TEST(SplitPacking, IsFineDownToItsFineDepth) {
  const BoxSolid box({-6e-3, -6e-3, -16e-3}, {6e-3, 6e-3, 0.0});
  // the zone is a spot of the top face
  const SurfaceZone zone(box, Ball{.center_m = Vector3::Zero(), .radius_m = 1e-3});
  SplitPackingParams params{.fine_depth_m = 5e-3};
  double largest_m = 0.0, largest_below_m = 0.0;
  for (const Ball& ball : BuildSplitPacking(box, zone, params)) {
    const double depth = zone.DepthAt(ball.center_m);
    if (depth < params.fine_depth_m) largest_m = std::max(largest_m, ball.radius_m);
    if (depth > params.fine_depth_m + 4e-3) largest_below_m = std::max(largest_below_m, ball.radius_m);
  }
  EXPECT_LE(largest_m, params.radius_over_spacing * params.spacing_m + 1e-12);
  EXPECT_GT(largest_below_m, 1.5 * params.radius_over_spacing * params.spacing_m);
}

}  // namespace
}  // namespace osteon::simulation
