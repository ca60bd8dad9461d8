#include "simulation/packing/point_spectrum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "base/parallel.h"

namespace osteon::simulation {
namespace {

using Wave = std::array<int, 3>;  // number of waves along each side of a window

void Check(const SpectrumParams& p) {
  const auto check_range = [](const char* name, double value, double low, double high) {
    if (value >= low && value <= high) return;
    throw std::invalid_argument(
        fmt::format("spectrum: {}: found {:g}, accepted {:g} … {:g}", name, value, low, high));
  };
  check_range("greatest frequency", p.max_frequency, 0.1, 10.0);
  check_range("bins", p.bins, 1, 1000);
  check_range("waves per bin", p.waves_per_bin, 1, 10'000);
}

/// Draws up to waves_per_bin different wave vectors with lengths in bin b. Directions and lengths are random;
/// each vector is rounded to whole numbers of waves along the window's sides. The lowest bins of a window
/// have few such vectors, or none.
std::vector<Wave> DrawWaves(int b, double spacing_m, const Vector3& sides_m, const SpectrumParams& params) {
  const double width = params.max_frequency / params.bins;
  CellRandom random({.index = {b, 0, 0}}, params.seed);
  std::vector<Wave> waves;
  for (int tried = 0; tried < 4 * params.waves_per_bin; ++tried) {
    if (static_cast<int>(waves.size()) == params.waves_per_bin) break;
    const double z = 2.0 * random.Next() - 1.0, around = 2.0 * std::numbers::pi * random.Next();
    const double across = std::sqrt(1.0 - z * z), length = (b + random.Next()) * width / spacing_m;
    const Vector3 direction(across * std::cos(around), across * std::sin(around), z);
    Wave wave{};
    Vector3 k;
    bool within_taper = true;
    for (int axis = 0; axis < 3; ++axis) {
      wave[axis] = static_cast<int>(std::lround(length * direction[axis] * sides_m[axis]));
      k[axis] = wave[axis] / sides_m[axis];
      within_taper = within_taper && std::abs(wave[axis]) <= 1;
    }
    const double rounded = k.norm() * spacing_m;
    if (within_taper || rounded < b * width || rounded >= (b + 1) * width) continue;
    // the opposite wave has the same power, so only one of both is used
    const Wave opposite{-wave[0], -wave[1], -wave[2]};
    if (std::find(waves.begin(), waves.end(), wave) == waves.end() &&
        std::find(waves.begin(), waves.end(), opposite) == waves.end())
      waves.push_back(wave);
  }
  return waves;
}

/// Sum of the power over a bin's wave vectors, and their number.
struct Power {
  double sum{0.0};
  std::size_t waves{0};
};

/// Power in each bin, in one window.
std::vector<Power> WindowPowers(const std::vector<Vector3>& points_m, const Eigen::AlignedBox3d& window,
                                const SpectrumParams& params) {
  const Vector3 sides = window.sizes();
  const double spacing = std::cbrt(window.volume() / static_cast<double>(points_m.size()));
  std::vector<double> weights;
  double squared_weights = 0.0;
  for (const Vector3& p : points_m) {
    double w = 1.0;
    for (int axis = 0; axis < 3; ++axis)
      w *= 1.0 - std::cos(2.0 * std::numbers::pi * (p[axis] - window.min()[axis]) / sides[axis]);
    weights.push_back(w);
    squared_weights += w * w;
  }
  std::vector<Power> powers(params.bins);
  ParallelFor(
      powers.size(), params.threads,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b)
          for (const Wave& wave : DrawWaves(static_cast<int>(b), spacing, sides, params)) {
            Vector3 k;
            for (int axis = 0; axis < 3; ++axis) k[axis] = 2.0 * std::numbers::pi * wave[axis] / sides[axis];
            std::complex<double> sum = 0.0;
            for (std::size_t i = 0; i < points_m.size(); ++i)
              sum += weights[i] * std::polar(1.0, -k.dot(points_m[i] - window.min()));
            powers[b].sum += std::norm(sum) / squared_weights;
            ++powers[b].waves;
          }
      },
      1);
  return powers;
}

}  // namespace

RadialSpectrum ComputeRadialSpectrum(std::span<const Vector3> points_m,
                                     std::span<const Eigen::AlignedBox3d> windows,
                                     const SpectrumParams& params) {
  Check(params);
  constexpr std::size_t kMinPoints = 20;
  std::vector<double> power(params.bins, 0.0), weight(params.bins, 0.0);
  for (const Eigen::AlignedBox3d& window : windows) {
    std::vector<Vector3> inside;
    for (const Vector3& p : points_m)
      if (window.contains(p)) inside.push_back(p);
    if (inside.size() < kMinPoints) continue;
    const std::vector<Power> powers = WindowPowers(inside, window, params);
    for (std::size_t b = 0; b < powers.size(); ++b) {
      if (powers[b].waves == 0) continue;
      const double n = static_cast<double>(inside.size());
      power[b] += n * powers[b].sum / static_cast<double>(powers[b].waves);
      weight[b] += n;
    }
  }
  RadialSpectrum spectrum;
  for (int b = 0; b < params.bins; ++b) {
    if (weight[b] == 0.0) continue;
    spectrum.frequency_per_mean_spacing.push_back((b + 0.5) * params.max_frequency / params.bins);
    spectrum.power.push_back(power[b] / weight[b]);
  }
  return spectrum;
}

std::vector<Eigen::AlignedBox3d> UniformWindows(const Solid& solid, const CutZone& zone,
                                                const MassPointParams& params, std::size_t max_windows) {
  constexpr double kMinWidth = 5.0;  // smallest width of a window, in spacings
  struct Room {
    Vector3 center;
    double half_m, width;  ///< half the side of the cube; its side in spacings
  };
  std::vector<Room> rooms;
  const std::vector<double>& from = params.cells.coarser_from_m;
  for (const Cell& cell : DivideGraded(solid, zone, params.cells, CellChoice::kSolid)) {
    // The largest cube around this centre lies in a ball of free_radius, in which all cells have this size.
    // The ball ends at the surface and at the depths at which the cells' size changes. Coarser cells extend
    // beyond such a depth by half their diagonal.
    const double depth = zone.DepthAt(cell.center());
    double free_radius = -cell.signed_distance_m;
    if (cell.level > 0) free_radius = std::min(free_radius, depth - from[cell.level - 1] - cell.reach_m());
    if (cell.level < static_cast<int>(from.size()))
      free_radius = std::min(free_radius, from[cell.level] - depth - 2.0 * cell.reach_m());
    const double half = free_radius / std::sqrt(3.0);
    if (2.0 * half >= kMinWidth * cell.side_m)
      rooms.push_back({cell.center(), half, 2.0 * half / cell.side_m});
  }
  std::stable_sort(rooms.begin(), rooms.end(),
                   [](const Room& a, const Room& b) { return a.width > b.width; });
  std::vector<Eigen::AlignedBox3d> windows;
  for (const Room& room : rooms) {
    if (windows.size() >= max_windows) break;
    const Eigen::AlignedBox3d box(room.center - Vector3::Constant(room.half_m),
                                  room.center + Vector3::Constant(room.half_m));
    if (std::none_of(windows.begin(), windows.end(),
                     [&box](const Eigen::AlignedBox3d& other) { return other.intersects(box); }))
      windows.push_back(box);
  }
  return windows;
}

}  // namespace osteon::simulation
