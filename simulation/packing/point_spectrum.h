#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "simulation/packing/mass_points.h"
#include "simulation/solids/cut_zone.h"

namespace osteon::simulation {

/// Power spectrum of a point set, as a function of the length of the wave vector. Independent points have
/// power 1 everywhere. Blue noise has a peak near one wave per mean spacing, and almost no power below. A
/// lattice has separate lines.
struct RadialSpectrum {
  std::vector<double> frequency_per_mean_spacing;  ///< waves per (volume / points)^(1/3); bin centres
  std::vector<double> power;                       ///< mean over the bin's wave vectors, and over windows
};

struct SpectrumParams {
  double max_frequency{3.0};  ///< waves per mean spacing; above 0, at most 10
  int bins{60};               ///< 1 … 1000
  int waves_per_bin{48};      ///< wave vectors drawn in each bin and window; 1 … 10 000
  std::uint64_t seed{1};      ///< selects the wave vectors
  int threads{0};             ///< 0: one per core. The result does not depend on it.
};

/// Radially averaged power spectrum of the points in each window, averaged over the windows with their number
/// of points as weight. Points must be equally dense within a window, but not from window to window.
///
///     P(k) = |Σ w(x) e^(-2πi k·x)|² / Σ w(x)²,   w = Π (1 - cos 2π(x - low)/side), side of each axis
///
/// A wave vector has a whole number of waves along each side of the window. k is a wave vector, x a point,
/// low the window's lower corner. Wave vectors with all three numbers in -1 … 1 are left out, because the
/// taper w itself has power there. Windows with fewer than 20 points are left out; if no window is left, the
/// spectrum is empty.
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] RadialSpectrum ComputeRadialSpectrum(std::span<const Vector3> points_m,
                                                   std::span<const Eigen::AlignedBox3d> windows,
                                                   const SpectrumParams& params = {});

/// Finds separate cubes inside the solid, in each of which the mass points are equally dense. The cubes with
/// the most spacings per side come first; each is at least five spacings wide.
/// @param max_windows  largest number of cubes
[[nodiscard]] std::vector<Eigen::AlignedBox3d> UniformWindows(const Solid& solid, const CutZone& zone,
                                                              const MassPointParams& params,
                                                              std::size_t max_windows = 32);

}  // namespace osteon::simulation
