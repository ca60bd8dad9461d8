#include "simulation/removal/cut_metrics.h"

#include <random>

#include <gtest/gtest.h>

#include "simulation/bone/scenes.h"
#include "simulation/tools/swept_tool.h"

// Tests of the measures of a cut: first hit of a ray, remaining balls, depth of the apex, swept volume and
// reamed depth.

namespace osteon::simulation {
namespace {

Ball BallAt(const Vector3& c, double r) { return {.center_m = c, .radius_m = r}; }

TEST(FirstHit, IsWhereTheRayEntersTheNearestBall) {
  const std::vector<Ball> balls{BallAt({0, 0, 10}, 2), BallAt({0, 0, 5}, 1), BallAt({5, 0, 3}, 1)};
  EXPECT_DOUBLE_EQ(FirstHit(balls, {0, 0, 0}, Vector3::UnitZ()).value(), 4.0);
  EXPECT_DOUBLE_EQ(FirstHit(balls, {0.6, 0, 0}, Vector3::UnitZ()).value(), 5.0 - 0.8);
  // this ray passes the nearer ball
  EXPECT_DOUBLE_EQ(FirstHit(balls, {0, 1.2, 0}, Vector3::UnitZ()).value(), 10.0 - 1.6);
  const Vector3 slanting = Vector3(5, 0, 3).normalized();
  EXPECT_NEAR(FirstHit(balls, {0, 0, 0}, slanting).value(), std::sqrt(34.0) - 1.0, 1e-12);
}

TEST(FirstHit, IsZeroInsideABallAndEmptyForARayThatMissesAll) {
  const std::vector<Ball> balls{BallAt({0, 0, 10}, 2)};
  EXPECT_EQ(FirstHit(balls, {0, 0, 9}, Vector3::UnitX()).value(), 0.0);
  EXPECT_FALSE(FirstHit(balls, {0, 0, 0}, Vector3::UnitX()).has_value());
  EXPECT_FALSE(FirstHit(balls, {0, 0, 0}, -Vector3::UnitZ()).has_value());
  EXPECT_FALSE(FirstHit(std::vector<Ball>{BallAt({0, 0, 10}, 0)}, {0, 0, 0}, Vector3::UnitZ()).has_value());
  EXPECT_FALSE(FirstHit({}, {0, 0, 0}, Vector3::UnitZ()).has_value());
}

TEST(LiveBalls, AreTheBallsOfPositiveRadiusInMetres) {
  CarvedState state;
  state.balls = {1, 2, 3, 4, 5, 6, 7, 0, -1, -2, -3, 0.5f};
  const std::vector<Ball> live = LiveBalls(state);
  ASSERT_EQ(live.size(), 2u);
  EXPECT_LT((Vector3(live[0].center_m) - Vector3(1e-3, 2e-3, 3e-3)).norm(), 1e-15);
  EXPECT_DOUBLE_EQ(live[1].radius_m, 0.5e-3);
}

/// X_GP of a tool whose z axis points along -z of G, with its apex at p.
Pose Down(const Vector3& p) {
  Pose X = Pose::Identity();
  X.linear() = ExpRotation({M_PI, 0, 0});
  X.translation() = p;
  return X;
}

TEST(ApexDepth, IsZeroAtTheFirstBoneAlongTheCupsAxis) {
  Bone bone;
  bone.site = {.center_m = Vector3(0.1, 0, 0), .axis = Vector3(0, 0, 1), .radius_m = 0.024};
  bone.balls = {BallAt({0.1, 0, -0.035}, 0.010)};  // its top lies 25 mm below the centre
  const ApexDepth depth(bone, MakeReamer(0.022, 0.008, 0.1, 0.9, Vector3::Zero()));
  EXPECT_NEAR(depth.floor_m(), 0.025, 1e-15);
  EXPECT_NEAR(depth.DepthAt(Down({0.1, 0, -0.025})), 0.0, 1e-15);
  EXPECT_NEAR(depth.DepthAt(Down({0.1, 0, -0.027})), 0.002, 1e-15);
  EXPECT_NEAR(depth.DepthAt(Down({0.1, 0, -0.020})), -0.005, 1e-15);
  // rotating the tool about its head's centre does not change the depth
  Pose tilted = Pose::Identity();
  tilted.linear() = ExpRotation({0, 0.3, 0}) * ExpRotation({M_PI, 0, 0});
  tilted.translation() = Vector3(0.1, 0, -0.005) - tilted.linear() * Vector3(0, 0, -0.022);
  EXPECT_NEAR(depth.DepthAt(tilted), 0.002, 1e-12);
}

TEST(ApexDepth, IsMeasuredFromTheCupsRadiusIfThereIsNoBone) {
  const ApexDepth depth(Bone{}, MakeReamer(0.022, 0.008, 0.1, 0.9, Vector3::Zero()));
  EXPECT_EQ(depth.floor_m(), 0.024);
}

/// Volume that a ball of radius R removes below the cup's sphere of radius r: ball minus lens. The ball's
/// centre is on the cup's axis, d below the cup's centre.
double BelowTheCup(double R, double r, double d) {
  // lens of two balls from the volumes of its two caps (independent of LensVolume)
  const double x = (d * d + r * r - R * R) / (2 * d);  // distance of the common plane from the cup's centre
  const auto cap = [](double radius, double height) {
    return M_PI * height * height * (radius - height / 3.0);
  };
  const double lens = cap(r, r - x) + cap(R, R - (d - x));
  return 4.0 / 3.0 * M_PI * R * R * R - lens;
}

TEST(SweptVolume, APlungeIntoTheAcetabulumSweepsTheCrescentBelowTheCup) {
  const AcetabulumSolid solid{AcetabulumShape{}};
  const double r = 0.024;
  for (const auto& [R, depth] : {std::pair{0.020, 0.003}, std::pair{0.023, 0.003}}) {
    // the head is smaller than the cup, and cuts the cup only below the top face, as BelowTheCup assumes
    const Tool tool = MakeReamer(R, 0.008, 0.1, 0.9, Vector3::Zero());
    std::vector<Pose> path;
    for (int i = 0; i <= 20; ++i) path.push_back(Down({0, 0, -R - (r - R + depth) * i / 20.0}));
    const double expected = BelowTheCup(R, r, r - R + depth);
    EXPECT_NEAR(SweptVolume(solid, tool, path, 0.25e-3), expected, 0.01 * expected) << R;
  }
}

TEST(SweptVolume, CountsVolumeSweptTwiceOnceAndIgnoresTheShaft) {
  const AcetabulumSolid solid{AcetabulumShape{}};
  const Tool tool = MakeReamer(0.023, 0.008, 0.1, 0.9, Vector3::Zero());
  Tool head = tool;
  head.balls.resize(1);
  std::vector<Pose> there{Down({0, 0, -0.023}), Down({0, 0, -0.027})}, and_back = there;
  and_back.push_back(there[0]);
  and_back.push_back(there[1]);
  const double once = SweptVolume(solid, tool, there, 0.5e-3);
  EXPECT_GT(once, 1e-6);
  EXPECT_EQ(SweptVolume(solid, tool, and_back, 0.5e-3), once);
  EXPECT_EQ(SweptVolume(solid, head, there, 0.5e-3), once);
  EXPECT_EQ(SweptVolume(solid, tool, {}, 0.5e-3), 0.0);
  const std::vector<Pose> away{Down({0, 0, 0.1})};
  EXPECT_EQ(SweptVolume(solid, tool, away, 0.5e-3), 0.0);
}

TEST(SweptVolume, PosesAreJoinedByStraightLines) {
  // two poses sweep the same volume as two hundred on the straight line between them
  const AcetabulumSolid solid{AcetabulumShape{}};
  const Tool tool = MakeReamer(0.010, 0.005, 0.1, 0.9, Vector3::Zero());
  const Vector3 a(-0.010, 0, -0.025), b(0.010, 0.004, -0.030);
  std::vector<Pose> fine;
  for (int i = 0; i <= 200; ++i) fine.push_back(Down(a + i / 200.0 * (b - a)));
  const std::vector<Pose> coarse{Down(a), Down(b)};
  const double volume = SweptVolume(solid, tool, coarse, 0.5e-3);
  EXPECT_GT(volume, 1e-6);
  EXPECT_NEAR(SweptVolume(solid, tool, fine, 0.5e-3), volume, 1e-3 * volume);
}

/// Oracle for SweptVolume, which skips whole blocks of cells: tests every cell, on one thread.
double CellByCell(const Solid& solid, const Tool& tool, std::span<const Pose> X_GP, double cell_m) {
  const SweptTool swept(tool, X_GP);
  const Eigen::AlignedBox3d box = swept.Bounds().intersection(solid.Bounds());
  const Eigen::Vector3i count = (box.sizes() / cell_m).array().ceil().max(1.0).cast<int>();
  const Vector3 step = box.sizes().array() / count.cast<double>().array();
  std::int64_t inside = 0;
  for (int i = 0; i < count.x(); ++i)
    for (int j = 0; j < count.y(); ++j)
      for (int k = 0; k < count.z(); ++k) {
        const Vector3 p = box.min() + step.cwiseProduct(Vector3(i + 0.5, j + 0.5, k + 0.5));
        if (swept.SignedDistance(p) < 0.0 && solid.SignedDistance(p) < 0.0) ++inside;
      }
  return static_cast<double>(inside) * step.prod();
}

TEST(SweptVolume, EqualsTheCountOfCellsForAnyNumberOfThreads) {
  const AcetabulumSolid solid{AcetabulumShape{}};
  std::vector<Pose> path;
  for (int i = 0; i <= 30; ++i) path.push_back(Down({2e-4 * i, 1e-4 * i, -0.020 - 3e-4 * i}));
  for (const double R : {0.004, 0.021}) {
    const Tool tool = MakeReamer(R, 0.003, 0.1, 0.9, Vector3::Zero());
    const double expected = CellByCell(solid, tool, path, 0.6e-3);
    EXPECT_GT(expected, 1e-7);
    for (const int threads : {1, 3})
      EXPECT_EQ(SweptVolume(solid, tool, path, 0.6e-3, threads), expected) << R;
  }
}

/// Frames of a tool whose apex moves down the axis from `from_m` to `to_m` below the cup's centre. Bone lies
/// between `bone_from_m` and `bone_to_m`, where the removed volume is `area_m2` times the depth.
std::vector<FrameRecord> Plunge(double from_m, double to_m, double bone_from_m, double bone_to_m,
                                double area_m2) {
  std::vector<FrameRecord> frames;
  constexpr int kFrames = 2000;
  for (int i = 0; i <= kFrames; ++i) {
    const double at_m = from_m + (to_m - from_m) * i / kFrames;
    FrameRecord frame;
    frame.model.frame = static_cast<std::uint64_t>(i) + 1;
    frame.model.X_WP = Down({0, 0, -at_m});
    const double cut_m = std::clamp(at_m, bone_from_m, bone_to_m) - bone_from_m;
    frame.model.F_T_W.f = Vector3(0, 0, cut_m > 0.0 && at_m <= bone_to_m ? 20.0 : 0.0);
    frame.model.removed_volume_m3 = 3e-10 * std::floor(area_m2 * cut_m / 3e-10);  // point by point
    frames.push_back(frame);
  }
  return frames;
}

/// Reamed depth [m] after these frames, in a bone without balls.
double ReamedBy(const Tool& tool, const std::vector<FrameRecord>& frames) {
  ReamedDepth reamed(Bone{}, tool, Pose::Identity());
  for (const FrameRecord& frame : frames) reamed.Add(frame);
  return reamed.depth_m();
}

TEST(ReamedDepth, IsTheDepthOverWhichTheApexRemovedBone) {
  const double R = 0.022;
  const Tool tool = MakeReamer(R, 0.008, 0.1, 0.9, Vector3::Zero());
  const double area_m2 = 0.3 * M_PI * R * R;
  // 3 mm of air, then 5 mm of bone
  EXPECT_NEAR(ReamedBy(tool, Plunge(0.0, 0.008, 0.003, 0.008, area_m2)), 0.005, 1e-5);
  // through a plate of 5 mm and 20 mm beyond: accurate to a step of 0.25 mm
  EXPECT_NEAR(ReamedBy(tool, Plunge(0.0, 0.028, 0.003, 0.008, area_m2)), 0.005, 0.26e-3);
  // sliding past bone: 2 mm³ along 38 mm are too little to count as reaming
  EXPECT_EQ(ReamedBy(tool, Plunge(0.0, 0.041, 0.003, 0.041, 2e-9 / 0.038)), 0.0);
  EXPECT_EQ(ReamedBy(tool, {}), 0.0);
}

}  // namespace
}  // namespace osteon::simulation
