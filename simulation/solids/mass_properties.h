#pragma once

#include <span>
#include <vector>

#include "simulation/bone/bone.h"
#include "simulation/mesh/triangle_mesh.h"

namespace osteon::simulation {

/// Volume, mass, centre of mass and inertia, in G.
struct MassProperties {
  double volume_m3{0.0};
  double mass_kg{0.0};
  Vector3 center_of_mass_m{Vector3::Zero()};
  Matrix3 inertia_kg_m2{Matrix3::Zero()};  ///< about the centre of mass, along G's axes
};

/// Mass properties of a body of even density that fills a closed mesh. They are exact: a sum over the
/// tetrahedra that the triangles form with one point. For a tetrahedron of volume V with corners v_0 … v_3,
///
///     ∫ x dV = V/4 Σ v_i        ∫ x xᵀ dV = V/20 (Σ v_i v_iᵀ + Σ v_i Σ v_iᵀ)
///
/// @param density_kg_per_m3  may be negative for a removed part: mass and inertia are negative then. Source:
/// Tonon, Explicit Exact Formulas for the 3-D Tetrahedron Inertia Tensor, J. Math. Stat. 1, 2005.
[[nodiscard]] MassProperties MeshMassProperties(const TriangleMesh& mesh, double density_kg_per_m3);

/// Mass properties of a solid with regions of other densities. Layers are ignored.
/// @param densities_kg_per_m3  the solid's density, then one for each of loaded.regions; the last density is
///   used for all regions beyond the list
/// @throws std::invalid_argument if there is no density.
[[nodiscard]] MassProperties MeshMassProperties(const LoadedMesh& loaded,
                                                std::span<const double> densities_kg_per_m3);

/// Mass properties of a cloud of mass points. Each point is treated as an even ball of its volume; this adds
/// a small part of the inertia.
/// @throws std::invalid_argument if a point's material is not in the list.
[[nodiscard]] MassProperties PointMassProperties(std::span<const MassPoint> points,
                                                 std::span<const Material> materials);

/// Mass properties of several bodies together. Overlapping volume is counted for each body. If the total mass
/// is zero, the centre is the origin.
[[nodiscard]] MassProperties Combine(std::span<const MassProperties> bodies);

}  // namespace osteon::simulation
