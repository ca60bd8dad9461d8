#pragma once

#include <span>

#include "simulation/solids/mass_properties.h"
#include "simulation/tools/tool.h"
#include "simulation/tools/tool_profile.h"

namespace osteon::simulation {

/// Mass properties of a solid of revolution about z with radius r(z) and even density ρ, in closed form:
///
///     m = πρ ∫ r² dz     p_z = πρ/m ∫ z r² dz     I_zz = πρ/2 ∫ r⁴ dz
///     I_xx = I_zz/2 + πρ ∫ (z - p_z)² r² dz
///
/// On each piece r² is a polynomial of degree 2 at most, so all integrands are of degree 4 at most, for which
/// three Gauss points are exact. The density of a fluted piece is multiplied by its metal_ratio, as if the
/// metal were spread evenly over the circle.
/// @param density_kg_per_m3  may be negative for a hollow part: mass and inertia are negative then
[[nodiscard]] MassProperties RevolvedMassProperties(std::span<const ProfilePiece> pieces,
                                                    double density_kg_per_m3);

/// Mass properties of a cylinder about z.
[[nodiscard]] MassProperties CylinderMassProperties(double radius_m, double front_z_m, double back_z_m,
                                                    double density_kg_per_m3);

/// Mass properties of a hemispherical shell of constant thickness, open to the back, with its apex at z = 0.
/// They are those of the outer half ball less those of the inner one.
[[nodiscard]] MassProperties HemisphericalShellMassProperties(double outer_radius_m, double thickness_m,
                                                              double density_kg_per_m3);

/// Sets the tool's mass, centre of mass and inertia.
void SetMass(const MassProperties& mass, Tool& tool);

}  // namespace osteon::simulation
