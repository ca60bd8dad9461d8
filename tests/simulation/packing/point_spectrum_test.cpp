#include "simulation/packing/point_spectrum.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>

#include "simulation/solids/acetabulum_solid.h"
#include "tests/oracles/neighbor_distances.h"

// Tests of two statistics of point sets, radial spectrum and distances of neighbours, on independent points
// and lattices, for which both are known.

namespace osteon::simulation {
namespace {

const Eigen::AlignedBox3d kBox(Vector3(-0.01, 0.0, 0.02), Vector3(0.01, 0.02, 0.04));

/// Random points in kBox, each independent of the others.
std::vector<Vector3> IndependentPoints(std::size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  std::vector<Vector3> points(count);
  for (Vector3& p : points) {
    const double x = u(random), y = u(random),
                 z = u(random);  // apart, since the order of arguments is not fixed
    p = kBox.min() + kBox.sizes().cwiseProduct(Vector3(x, y, z));
  }
  return points;
}

/// A cubic lattice, n points along each side.
std::vector<Vector3> Lattice(int n) {
  std::vector<Vector3> points;
  for (int i = 0; i < n * n * n; ++i)
    points.emplace_back(kBox.min() + kBox.sizes().cwiseProduct(Vector3(i % n, i / n % n, i / n / n)) / n);
  return points;
}

// A wave's power over independent points is exponentially distributed with mean 1. The mean of a bin of 48
// waves has a standard deviation of 0.14, and more where the taper makes neighbouring waves similar.
TEST(RadialSpectrum, IndependentPointsHaveAWhiteSpectrum) {
  const RadialSpectrum spectrum = ComputeRadialSpectrum(IndependentPoints(4000), std::vector{kBox});
  ASSERT_GE(spectrum.power.size(), 50u);
  double sum = 0.0;
  for (std::size_t i = 0; i < spectrum.power.size(); ++i) {
    EXPECT_NEAR(spectrum.power[i], 1.0, 0.9) << spectrum.frequency_per_mean_spacing[i];
    sum += spectrum.power[i];
  }
  EXPECT_NEAR(sum / static_cast<double>(spectrum.power.size()), 1.0, 0.08);
}

// A cubic lattice of spacing 1 has power only at wave vectors of whole numbers: frequencies 1, √2, √3, 2, √5
// …
TEST(RadialSpectrum, ALatticeHasPowerOnlyAtItsLines) {
  const RadialSpectrum spectrum = ComputeRadialSpectrum(
      Lattice(10), std::vector{kBox}, {.max_frequency = 1.6, .bins = 32, .waves_per_bin = 4000});
  double between = 0.0, line = 0.0;
  for (std::size_t i = 0; i < spectrum.power.size(); ++i) {
    const double f = spectrum.frequency_per_mean_spacing[i];
    // the taper widens a line by one wave of the box along each axis, a tenth of the lattice's frequency
    const bool near_line = std::min(std::abs(f - 1.0), std::abs(f - std::sqrt(2.0))) < 0.2;
    if (near_line) line = std::max(line, spectrum.power[i]);
    if (f < 0.8) between = std::max(between, spectrum.power[i]);
  }
  EXPECT_LT(between, 1e-20);
  EXPECT_GT(line, 3.0);
}

TEST(RadialSpectrum, DoesNotDependOnTheNumberOfThreadsOrTheScale) {
  std::vector<Vector3> points = IndependentPoints(1000);
  const RadialSpectrum one = ComputeRadialSpectrum(points, std::vector{kBox}, {.threads = 1});
  EXPECT_EQ(ComputeRadialSpectrum(points, std::vector{kBox}, {.threads = 3}).power, one.power);
  for (Vector3& p : points) p *= 8.0;  // a power of two: the same bits
  const std::vector wide{Eigen::AlignedBox3d(8.0 * kBox.min(), 8.0 * kBox.max())};
  EXPECT_EQ(ComputeRadialSpectrum(points, wide).power.size(), one.power.size());
  EXPECT_NEAR(ComputeRadialSpectrum(points, wide).power[20], one.power[20], 1e-9);
}

TEST(RadialSpectrum, IsEmptyForTooFewPointsAndRefusesWrongParametersByName) {
  EXPECT_TRUE(ComputeRadialSpectrum(IndependentPoints(19), std::vector{kBox}).power.empty());
  EXPECT_TRUE(ComputeRadialSpectrum({}, {}).power.empty());
  const auto message = [](const SpectrumParams& params) -> std::string {
    try {
      (void)ComputeRadialSpectrum({}, {}, params);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message({.bins = 0}), "spectrum: bins: found 0, accepted 1 … 1000");
  EXPECT_EQ(message({.max_frequency = std::nan("")}),
            "spectrum: greatest frequency: found nan, accepted 0.1 … 10");
}

TEST(UniformWindows, LieInTheSolidWithoutOverlapAndEachHasOneSpacing) {
  const AcetabulumSolid solid{{}};
  const CupZone zone(solid.cup());
  const MassPointParams params;
  const std::vector<Eigen::AlignedBox3d> windows = UniformWindows(solid, zone, params);
  ASSERT_FALSE(windows.empty());
  const std::vector<Cell> cells = DivideGraded(solid, zone, params.cells, CellChoice::kSolid);
  for (std::size_t i = 0; i < windows.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(windows[i].intersects(windows[j]));
    double least = 1.0, greatest = 0.0;
    for (const Cell& cell : cells) {
      if (!windows[i].contains(cell.center())) continue;
      least = std::min(least, cell.side_m);
      greatest = std::max(greatest, cell.side_m);
    }
    EXPECT_EQ(least, greatest);
    EXPECT_GE(windows[i].sizes().x(), 5.0 * greatest);
    for (int corner = 0; corner < 8; ++corner)
      EXPECT_LT(solid.SignedDistance(windows[i].corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner))),
                0.0);
  }
}

TEST(NeighborDistances, AreTheSpacingOfALattice) {
  const std::vector<Vector3> points = Lattice(9);
  const double side = kBox.sizes().x() / 9;
  const NeighborDistances d =
      MeasureNeighborDistances(points, std::vector<double>(points.size(), 2.0 * side));
  EXPECT_NEAR(d.min_over_spacing, 0.5, 1e-12);
  EXPECT_NEAR(d.mean_over_spacing, 0.5, 1e-12);
}

// Hertz 1909: the nearest neighbour of independent points is 0.554 mean spacings away on average; the box's
// borders increase this slightly.
TEST(NeighborDistances, AgreeWithTheoryForIndependentPoints) {
  const std::vector<Vector3> points = IndependentPoints(8000);
  const NeighborDistances d =
      MeasureNeighborDistances(points, std::vector<double>(points.size(), kBox.sizes().x() / 20));
  EXPECT_NEAR(d.mean_over_spacing, 0.554, 0.02);
  EXPECT_LT(d.min_over_spacing, 0.05);
  double sum = 0.0;
  for (const double share : d.histogram) sum += share;
  EXPECT_NEAR(sum, 1.0, 1e-9);
}

TEST(NeighborDistances, UseTheLargerSpacingOfAPairAndFindCoincidentPoints) {
  const std::vector<Vector3> pair{{0, 0, 0}, {1e-3, 0, 0}};
  EXPECT_NEAR(MeasureNeighborDistances(pair, std::vector{1e-3, 4e-3}).min_over_spacing, 0.25, 1e-15);
  const std::vector<Vector3> same{{1, 2, 3}, {1, 2, 3}, {1, 2, 4}};
  EXPECT_EQ(MeasureNeighborDistances(same, std::vector{1.0, 1.0, 1.0}).min_over_spacing, 0.0);
  EXPECT_THROW((void)MeasureNeighborDistances(same, std::vector{1.0}), std::invalid_argument);
  EXPECT_THROW((void)MeasureNeighborDistances(pair, std::vector{1.0, 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::simulation
