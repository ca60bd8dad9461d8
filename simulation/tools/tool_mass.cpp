#include "simulation/tools/tool_mass.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace osteon::simulation {
namespace {

/// r² of a piece at the height z [m²].
double SquaredRadius(const ProfilePiece& p, double z) {
  if (p.sphere_radius_m > 0.0)
    return p.sphere_radius_m * p.sphere_radius_m - (z - p.sphere_z_m) * (z - p.sphere_z_m);
  const double r = p.front_r_m + (z - p.front_z_m) / (p.back_z_m - p.front_z_m) * (p.back_r_m - p.front_r_m);
  return r * r;
}

}  // namespace

MassProperties RevolvedMassProperties(std::span<const ProfilePiece> pieces, double density_kg_per_m3) {
  // Gauss points and their weights on -1 … 1.
  const std::array<double, 3> kAt{-std::sqrt(0.6), 0.0, std::sqrt(0.6)};
  constexpr std::array<double, 3> kWeight{5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};
  // one body for each piece, with its inertia about its own centre: this avoids cancellation
  std::vector<MassProperties> bodies;
  for (const ProfilePiece& piece : pieces) {
    const double middle = 0.5 * (piece.front_z_m + piece.back_z_m);
    const double half = 0.5 * (piece.front_z_m - piece.back_z_m);
    if (half <= 0.0) continue;  // a flat face has no volume
    // The integrals of r², r² z, r² z² and r⁴ over the piece, with z from the piece's middle.
    double volume = 0.0, first = 0.0, second = 0.0, fourth = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double z = half * kAt[i], weight = half * kWeight[i], rr = SquaredRadius(piece, middle + z);
      volume += weight * rr;
      first += weight * rr * z;
      second += weight * rr * z * z;
      fourth += weight * rr * rr;
    }
    const double scale = std::numbers::pi * piece.metal_ratio;
    const double offset = first / volume;
    const double I_zz = 0.5 * scale * density_kg_per_m3 * fourth;
    const double I_xx = 0.5 * I_zz + scale * density_kg_per_m3 * (second - offset * first);
    bodies.push_back({.volume_m3 = scale * volume,
                      .mass_kg = scale * density_kg_per_m3 * volume,
                      .center_of_mass_m = Vector3(0.0, 0.0, middle + offset),
                      .inertia_kg_m2 = Vector3(I_xx, I_xx, I_zz).asDiagonal()});
  }
  return Combine(bodies);
}

MassProperties CylinderMassProperties(double radius_m, double front_z_m, double back_z_m,
                                      double density_kg_per_m3) {
  const ProfilePiece piece{
      .front_z_m = front_z_m, .front_r_m = radius_m, .back_z_m = back_z_m, .back_r_m = radius_m};
  return RevolvedMassProperties({&piece, 1}, density_kg_per_m3);
}

MassProperties HemisphericalShellMassProperties(double outer_radius_m, double thickness_m,
                                                double density_kg_per_m3) {
  const auto half_ball = [&](double radius_m, double density) {
    const ProfilePiece piece{.front_z_m = radius_m - outer_radius_m,
                             .back_z_m = -outer_radius_m,
                             .back_r_m = radius_m,
                             .sphere_radius_m = radius_m,
                             .sphere_z_m = -outer_radius_m};
    return RevolvedMassProperties({&piece, 1}, density);
  };
  const std::array<MassProperties, 2> halves{half_ball(outer_radius_m, density_kg_per_m3),
                                             half_ball(outer_radius_m - thickness_m, -density_kg_per_m3)};
  MassProperties shell = Combine(halves);
  shell.volume_m3 = halves[0].volume_m3 - halves[1].volume_m3;
  return shell;
}

void SetMass(const MassProperties& mass, Tool& tool) {
  tool.mass_kg = mass.mass_kg;
  tool.center_of_mass_m = mass.center_of_mass_m;
  tool.inertia_kg_m2 = mass.inertia_kg_m2;
}

}  // namespace osteon::simulation
