#include "simulation/packing/mass_points.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "simulation/packing/point_spectrum.h"
#include "simulation/solids/acetabulum_solid.h"
#include "tests/oracles/neighbor_distances.h"
#include "tests/simulation/engine/engine_bench.h"

// Tests of the mass points of a bone: their volumes, moments and material against closed forms, their
// spacing, and their spectrum.

namespace osteon::simulation {
namespace {

constexpr double kCupRadius_m = 0.024;

/// Volume of half a spherical shell.
double HalfShell_m3(double inner_m, double outer_m) {
  return 2.0 / 3.0 * std::numbers::pi * (std::pow(outer_m, 3) - std::pow(inner_m, 3));
}

/// The mass points of the default acetabulum: a block of 80 × 80 × 60 mm with a cup of radius 24 mm.
class MassPoints : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    points_ = BuildMassPoints(AcetabulumSolid{{}}, CupZone{AcetabulumSolid{{}}.cup()}, {});
  }
  /// Sum of the volumes of points for which where(position, point) is true.
  template <typename Where>
  static double Volume_m3(Where where) {
    double sum = 0.0;
    for (const MassPoint& point : points_)
      if (where(Vector3(point.p_m), point)) sum += point.volume_m3;
    return sum;
  }
  inline static std::vector<MassPoint> points_;
};

TEST_F(MassPoints, LieInTheBoneAndNumberSixtyToAHundredTwentyThousand) {
  EXPECT_GE(points_.size(), 60'000u);
  EXPECT_LE(points_.size(), 120'000u);
  for (const MassPoint& point : points_) {
    const Vector3 p = point.p_m;
    ASSERT_TRUE(p.norm() >= kCupRadius_m && p.cwiseAbs().head<2>().maxCoeff() <= 0.04 && p.z() <= 0 &&
                p.z() >= -0.06);
    ASSERT_GT(point.volume_m3, 0.0);
  }
}

TEST_F(MassPoints, SumUpToTheVolumeOfTheBone) {
  const double exact = 0.08 * 0.08 * 0.06 - HalfShell_m3(0.0, kCupRadius_m);
  EXPECT_NEAR(Volume_m3([](const Vector3&, const MassPoint&) { return true; }), exact, 0.005 * exact);
}

// A shell 1 mm thick cuts through cells of 0.75 mm. The sampling error over many depths is 0.33 % rms.
TEST_F(MassPoints, SumUpToTheVolumeOfEachMillimetreBelowTheCup) {
  for (int mm = 0; mm < 4; ++mm) {
    const double low = kCupRadius_m + mm * 1e-3, high = low + 1e-3, exact = HalfShell_m3(low, high);
    EXPECT_NEAR(
        Volume_m3([&](const Vector3& p, const MassPoint&) { return p.norm() >= low && p.norm() < high; }),
        exact, 0.01 * exact)
        << mm;
  }
}

TEST_F(MassPoints, SumUpToTheVolumeOfEachTissue) {
  const double cartilage = HalfShell_m3(kCupRadius_m, 0.026), cortical = HalfShell_m3(0.026, 0.027);
  const auto volume = [](MaterialIndex i) {
    return Volume_m3([i](const Vector3&, const MassPoint& point) { return point.material == i; });
  };
  EXPECT_NEAR(volume(kCartilage), cartilage, 0.01 * cartilage);
  EXPECT_NEAR(volume(kCortical), cortical, 0.01 * cortical);
}

// The swept volume of the demo: the crescent between the cup and a reamer of diameter 50 mm whose centre is 3
// mm below the cup's.
TEST_F(MassPoints, SumUpToTheVolumeThatAReamerSweeps) {
  const double reamer = 0.025, depth = 0.003;
  double exact = 0.0;  // integrated by slices across the axis
  const double dz = 1e-6;
  for (double z = -0.5 * dz; z > -(depth + reamer); z -= dz) {
    const double below = std::min(0.0, z + depth);
    const double outer = std::max(0.0, reamer * reamer - below * below);
    const double inner = std::max(0.0, kCupRadius_m * kCupRadius_m - z * z);
    exact += std::numbers::pi * std::max(0.0, outer - inner) * dz;
  }
  const double sum = Volume_m3([&](const Vector3& p, const MassPoint&) {
    return (p - Vector3(0, 0, std::max(-depth, p.z()))).norm() <= reamer;
  });
  EXPECT_GT(exact, 5e-6);
  EXPECT_NEAR(sum, exact, 0.01 * exact);
}

// Root mean square of the relative error over shells 1 mm thick at depths about 0.04 mm apart: measured 0.33
// %. A random point in each cell would give 0.61 %, a quasi-random point 0.43 %.
TEST_F(MassPoints, GiveShellVolumesThatVaryLittleWithDepth) {
  double squares = 0.0;
  int shells = 0;
  for (double low = kCupRadius_m; low < kCupRadius_m + 3e-3; low += 0.0437e-3, ++shells) {
    const double exact = HalfShell_m3(low, low + 1e-3);
    const double sum = Volume_m3(
        [&](const Vector3& p, const MassPoint&) { return p.norm() >= low && p.norm() < low + 1e-3; });
    squares += std::pow(sum / exact - 1.0, 2);
  }
  EXPECT_LE(std::sqrt(squares / shells), 0.0043);
}

TEST_F(MassPoints, HaveTheBonesCenterOfMassAndSecondMoments) {
  const double R = kCupRadius_m, block = 0.08 * 0.08 * 0.06, exact = block - HalfShell_m3(0.0, R);
  Vector3 first = Vector3::Zero(), second = Vector3::Zero();
  for (const MassPoint& point : points_) {
    const Vector3 p = point.p_m;
    first += point.volume_m3 * p;
    second += point.volume_m3 * p.cwiseProduct(p);
  }
  const double z = (-block * 0.03 + 0.25 * std::numbers::pi * std::pow(R, 4)) / exact;
  EXPECT_LE((first / exact - Vector3(0, 0, z)).norm(), 0.05e-3);
  const double ball = 2.0 / 15.0 * std::numbers::pi * std::pow(R, 5);
  const Vector3 moments(block * 0.08 * 0.08 / 12.0 - ball, block * 0.08 * 0.08 / 12.0 - ball,
                        block * 0.06 * 0.06 / 3.0 - ball);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(second[axis], moments[axis], 0.004 * moments[axis]);
}

// The smallest spacing that each point's cell may have. The spacing depends on the depth of the cell's
// centre, which may be half a diagonal away from the point.
std::vector<double> MinSpacings(const std::vector<MassPoint>& points, const CutZone& zone,
                                const GradeParams& cells) {
  std::vector<double> spacings;
  for (const MassPoint& point : points) {
    double spacing = cells.finest_m;
    for (const double from : cells.coarser_from_m)
      if (zone.DepthAt(point.p_m) - 2.0 * 0.866 * spacing >= from) spacing *= 2.0;
    spacings.push_back(spacing);
  }
  return spacings;
}

TEST_F(MassPoints, StayAtLeastHalfASpacingApart) {
  std::vector<Vector3> places;
  for (const MassPoint& point : points_) places.push_back(point.p_m);
  const std::vector<double> spacings =
      MinSpacings(points_, CupZone{AcetabulumSolid{{}}.cup()}, MassPointParams{}.cells);
  const NeighborDistances distances = MeasureNeighborDistances(places, spacings);
  EXPECT_GE(distances.min_over_spacing, 0.5);
  EXPECT_GE(distances.mean_over_spacing, 0.85);
}

// Every place in the bone has a point within 1.5 separations. At a border between cell sizes, the separation
// is that of the coarser cells.
TEST_F(MassPoints, LeaveNoHoles) {
  const AcetabulumSolid solid{{}};
  const CupZone zone(solid.cup());
  std::mt19937 random(2);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (int tried = 0; tried < 3000; ++tried) {
    const Vector3 p(0.04 * u(random), 0.04 * u(random), -0.03 + 0.03 * u(random));
    if (solid.SignedDistance(p) > 0.0) continue;
    const double depth = zone.DepthAt(p);
    const double spacing = depth > 12e-3 - 2.6e-3 ? 3e-3 : depth > 5e-3 - 1.3e-3 ? 1.5e-3 : 0.75e-3;
    double nearest = 1.0;
    for (const MassPoint& point : points_) nearest = std::min(nearest, (p - Vector3(point.p_m)).norm());
    // the samples of a cell are a quarter of a cell apart; 0.43 cells is the diagonal of this distance
    ASSERT_LE(nearest, (1.5 * kMassPointSeparation + 0.43) * spacing) << p.transpose();
  }
}

// Blue noise has almost no power below half of the peak's frequency, and the power of white noise far above
// it.
TEST_F(MassPoints, HaveTheSpectrumOfBlueNoise) {
  std::vector<Vector3> places;
  for (const MassPoint& point : points_) places.push_back(point.p_m);
  const AcetabulumSolid solid{{}};
  const std::vector<Eigen::AlignedBox3d> windows = UniformWindows(solid, CupZone{solid.cup()}, {});
  ASSERT_GE(windows.size(), 4u);
  const RadialSpectrum spectrum = ComputeRadialSpectrum(places, windows);
  const auto peak = std::max_element(spectrum.power.begin(), spectrum.power.end()) - spectrum.power.begin();
  const double at = spectrum.frequency_per_mean_spacing[peak];
  EXPECT_GT(at, 0.9);
  EXPECT_LT(at, 1.4);
  EXPECT_GT(spectrum.power[peak], 1.2);
  EXPECT_LT(spectrum.power[peak], 2.5);  // noise, not a lattice
  for (std::size_t i = 0; i < spectrum.power.size(); ++i) {
    const double f = spectrum.frequency_per_mean_spacing[i];
    if (f < 0.5 * at) {
      EXPECT_LT(spectrum.power[i], 0.25) << f;
    }
    if (f > 2.0) {
      EXPECT_NEAR(spectrum.power[i], 1.0, 0.3) << f;
    }
  }
}

// Plates, a rod and a small cube, all thinner than the points' spacing of 1 mm.
TEST(ThinMassPoints, SumUpToTheVolumeOfBoneThinnerThanTheirSpacing) {
  const auto box = [](double x, double y, double z) {
    return BoxSolid(Vector3(0.1e-3, 0.2e-3, 0.3e-3), Vector3(0.1e-3 + x, 0.2e-3 + y, 0.3e-3 + z));
  };
  struct Sliver {
    BoxSolid solid;
    std::size_t min_points;
    double tolerance;
  };
  // the tolerances are wide because few of a cell's 64 samples lie inside
  const Sliver slivers[] = {{box(20e-3, 20e-3, 0.2e-3), 120, 0.02},
                            {box(0.3e-3, 20e-3, 20e-3), 120, 0.02},
                            {box(0.4e-3, 0.4e-3, 30e-3), 15, 0.04},
                            {box(0.5e-3, 0.5e-3, 0.5e-3), 1, 0.25}};
  for (const Sliver& sliver : slivers) {
    const std::vector<MassPoint> points =
        BuildMassPoints(sliver.solid, EverywhereZone(), {.cells = {.finest_m = 1e-3, .coarser_from_m = {}}});
    double volume = 0.0;
    for (const MassPoint& point : points) volume += point.volume_m3;
    const double exact = sliver.solid.Bounds().volume();
    EXPECT_NEAR(volume, exact, sliver.tolerance * exact);
    EXPECT_GE(points.size(), sliver.min_points);
  }
}

// A cut may follow any face, so the volumes of thin layers below all faces must be right. Within a cell,
// volume is assigned by slabs that follow the surface; near the box's edges they follow only one of the two
// faces, which explains the tolerance. If each volume were assigned to the nearest point, the error would be
// 15 to 25 %.
TEST(UniformMassPoints, SumUpToTheVolumeOfThinLayersBelowEveryFace) {
  for (const double shift : {0.0, 1.0 / 3.0, 0.5}) {  // shift of the faces against the cells, in spacings
    const double half = 0.01, spacing = 0.5e-3, off = shift * spacing;
    const BoxSolid solid(Vector3::Constant(off - half), Vector3::Constant(off + half));
    const std::vector<MassPoint> points =
        BuildMassPoints(solid, EverywhereZone(), {.cells = {.finest_m = spacing, .coarser_from_m = {}}});
    for (const double depth : {0.1, 0.2, 0.4, 1.0, 2.0}) {  // in spacings
      double sum = 0.0;
      for (const MassPoint& point : points)
        if (solid.SignedDistance(point.p_m) > -depth * spacing) sum += point.volume_m3;
      const double exact = std::pow(2.0 * half, 3) - std::pow(2.0 * (half - depth * spacing), 3);
      EXPECT_NEAR(sum, exact, (depth < 0.15 ? 0.10 : 0.06) * exact) << shift << " " << depth;
    }
  }
}

TEST(MassPointsOfAnyThreads, AreEqualBitForBit) {
  const AcetabulumSolid solid{{.width_m = 0.05, .height_m = 0.03, .cup_radius_m = 0.012}};
  const CupZone zone(solid.cup());
  const std::vector<MassPoint> one = BuildMassPoints(solid, zone, {.threads = 1});
  for (const int threads : {2, 8}) {
    const std::vector<MassPoint> many = BuildMassPoints(solid, zone, {.threads = threads});
    ASSERT_EQ(many.size(), one.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
      ASSERT_EQ(Vector3(many[i].p_m), Vector3(one[i].p_m));
      ASSERT_EQ(many[i].volume_m3, one[i].volume_m3);
      ASSERT_EQ(many[i].material, one[i].material);
    }
  }
}

TEST_F(MassPoints, AreTheSameInEachRun) {
  const std::vector<MassPoint> again =
      BuildMassPoints(AcetabulumSolid{{}}, CupZone{AcetabulumSolid{{}}.cup()}, {});
  ASSERT_EQ(again.size(), points_.size());
  for (std::size_t i = 0; i < again.size(); ++i) {
    ASSERT_EQ(Vector3(again[i].p_m), Vector3(points_[i].p_m));
    ASSERT_EQ(again[i].volume_m3, points_[i].volume_m3);
  }
}

}  // namespace
}  // namespace osteon::simulation
