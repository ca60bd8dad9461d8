#include "simulation/tools/tool_compliance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "base/check_range.h"

namespace osteon::simulation {
namespace {

constexpr int kSlices = 256;  // number of slices of a piece
// share of a cantilever's mass that, placed at its free end, gives the same first frequency
constexpr double kVibratingShare = 0.236;

/// A slice of the free length, which is the part of the tool in front of the clamp.
struct Slice {
  double front_m, back_m;  ///< distances of front and back from the apex
  /// Stiffness against bending [N m²], along the axis [N] and against torsion [N m²]; infinite where rigid.
  double EI, EA, GJ;
  double mass_kg;
};

/// Cuts the free part of each piece into kSlices slices, from the apex back.
std::vector<Slice> SlicesOf(std::span<const BeamPiece> pieces, const BeamParams& p, double free_m) {
  std::vector<Slice> slices;
  const double shear_Pa = 0.5 * p.youngs_Pa / (1.0 + p.poisson);
  for (const BeamPiece& piece : pieces) {
    const double end_m = std::min(piece.to_m, free_m);
    for (int i = 0; i < kSlices && end_m > piece.from_m; ++i) {
      const double step_m = (end_m - piece.from_m) / kSlices, front_m = piece.from_m + i * step_m;
      // the radius in the slice's middle, and the circle's area and second moment of area, less the flutes
      const double along = (front_m + 0.5 * step_m - piece.from_m) / (piece.to_m - piece.from_m);
      const double r = piece.from_radius_m + along * (piece.to_radius_m - piece.from_radius_m);
      const double area_m2 = piece.area_ratio * std::numbers::pi * r * r;
      const double second_m4 = piece.second_moment_ratio * 0.25 * std::numbers::pi * r * r * r * r;
      Slice slice{.front_m = front_m,
                  .back_m = front_m + step_m,
                  .EI = p.youngs_Pa * second_m4,
                  .EA = p.youngs_Pa * area_m2,
                  .GJ = shear_Pa * 2.0 * second_m4,
                  .mass_kg = p.density_kg_per_m3 * area_m2 * step_m};
      if (piece.rigid) {
        slice.EI = slice.EA = slice.GJ = std::numeric_limits<double>::infinity();
        slice.mass_kg = 0.0;  // a rigid piece's mass is included in the head's mass
      }
      slices.push_back(slice);
    }
  }
  return slices;
}

/// Whether the free length bears a thrust P without buckling. The deflection z follows z'' = -P z / EI from z
/// = 0 at the tip; below the buckling thrust its slope stays positive up to the clamp.
bool Carries(const std::vector<Slice>& slices, double thrust_N) {
  double z = 0.0, slope = 1.0;
  for (const Slice& slice : slices) {
    const double h = slice.back_m - slice.front_m;
    if (std::isinf(slice.EI)) {
      z += slope * h;
      continue;
    }
    const double k = std::sqrt(thrust_N / slice.EI), c = std::cos(k * h), s = std::sin(k * h);
    const double z_front = z;
    z = z_front * c + slope * s / k;
    slope = slope * c - z_front * k * s;
    if (!(slope > 0.0)) return false;
  }
  return true;
}

/// The largest thrust [N] that the free length bears without buckling, by bisection.
double BucklingThrust(const std::vector<Slice>& slices) {
  double low_N = 0.0, high_N = 1.0;
  while (Carries(slices, high_N) && high_N < 1e9) high_N *= 2.0;
  for (int i = 0; i < 60; ++i) {
    const double middle_N = 0.5 * (low_N + high_N);
    (Carries(slices, middle_N) ? low_N : high_N) = middle_N;
  }
  return low_N;
}

void CheckPieces(std::span<const BeamPiece> pieces, const BeamParams& params) {
  if (pieces.empty())
    throw std::invalid_argument("bending: found no piece of a shaft, accepted at least one");
  CheckRangeMm("bending: clamped length", params.clamped_m, 0.0, 0.999 * pieces.back().to_m);
  if (!(params.youngs_Pa >= 1e8 && params.youngs_Pa <= 1e12))
    throw std::invalid_argument(fmt::format("bending: Young's modulus: found {:g} GPa, accepted 0.1 … 1000",
                                            1e-9 * params.youngs_Pa));
  if (!(params.poisson >= 0.0 && params.poisson <= 0.49))
    throw std::invalid_argument(
        fmt::format("bending: Poisson's ratio: found {:g}, accepted 0 … 0.49", params.poisson));
}

}  // namespace

ToolCompliance CantileverCompliance(std::span<const BeamPiece> pieces, const BeamParams& params) {
  CheckPieces(pieces, params);
  ToolCompliance result;
  result.free_length_m = pieces.back().to_m - params.clamped_m;
  const std::vector<Slice> slices = SlicesOf(pieces, params, result.free_length_m);
  double c_yy = 0.0, c_yt = 0.0, c_tt = 0.0, axial = 0.0, torsion = 0.0, shaft_kg = 0.0;
  for (const Slice& slice : slices) {
    const double a = slice.front_m, b = slice.back_m;
    c_yy += (b * b * b - a * a * a) / (3.0 * slice.EI);
    c_yt += (b * b - a * a) / (2.0 * slice.EI);
    c_tt += (b - a) / slice.EI;
    axial += (b - a) / slice.EA;
    torsion += (b - a) / slice.GJ;
    shaft_kg += slice.mass_kg;
  }
  if (!(c_yy > 0.0))
    throw std::invalid_argument(
        fmt::format("bending: clamped length: found {:g} mm, accepted less: nothing "
                    "flexible is free",
                    1e3 * params.clamped_m));
  Matrix6& C = result.C_T;
  C(0, 0) = C(1, 1) = c_yy;
  C(0, 4) = C(4, 0) = c_yt;
  C(1, 3) = C(3, 1) = -c_yt;
  C(3, 3) = C(4, 4) = c_tt;
  C(2, 2) = axial;
  C(5, 5) = torsion;
  result.lateral_N_per_m = 1.0 / LateralCompliance(C, params.load_point_m);
  result.buckling_N = BucklingThrust(slices);
  result.first_mode_hz =
      std::sqrt(result.lateral_N_per_m / (params.head_mass_kg + kVibratingShare * shaft_kg)) /
      (2.0 * std::numbers::pi);
  return result;
}

double LateralCompliance(const Matrix6& C_T, double behind_apex_m) {
  return C_T(0, 0) - 2.0 * behind_apex_m * C_T(0, 4) + behind_apex_m * behind_apex_m * C_T(4, 4);
}

double ThrustFactor(double thrust_N, double buckling_N) {
  if (!(thrust_N >= 0.0 && thrust_N < buckling_N))
    throw std::invalid_argument(
        fmt::format("bending: thrust: found {:g} N, accepted 0 … less than the {:.4g} N at "
                    "which the tool buckles",
                    thrust_N, buckling_N));
  return 1.0 / (1.0 - thrust_N / buckling_N);
}

std::vector<BeamPiece> BeamOf(const ToolProfile& profile) {
  // The head reaches from the apex to the first piece that does not cut, or that is straight or fluted and
  // begins at the full width.
  std::vector<BeamPiece> beam;
  bool in_head = true;
  for (const ProfilePiece& piece : profile.pieces()) {
    const bool fluted = piece.metal_ratio < 1.0;
    const bool begins_wide = piece.front_r_m >= piece.back_r_m && piece.front_r_m > 0.0;
    in_head = in_head && piece.cutting && !(fluted && begins_wide) &&
              !(begins_wide && piece.sphere_radius_m == 0.0);
    if (piece.front_z_m - piece.back_z_m <= 0.0) continue;  // a flat face has no length
    beam.push_back({.from_m = -piece.front_z_m,
                    .to_m = -piece.back_z_m,
                    .from_radius_m = piece.front_r_m,
                    .to_radius_m = piece.back_r_m,
                    .rigid = in_head,
                    .second_moment_ratio = fluted ? kFlutedSecondMoment : 1.0,
                    .area_ratio = piece.metal_ratio});
  }
  return beam;
}

}  // namespace osteon::simulation
