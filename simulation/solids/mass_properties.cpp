#include "simulation/solids/mass_properties.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

namespace osteon::simulation {
namespace {

/// Inertia from the second moment, the integral of x xᵀ over the mass.
Matrix3 InertiaOfSecondMoment(const Matrix3& moment) { return moment.trace() * Matrix3::Identity() - moment; }

/// Inertia of a unit point mass at the position d (parallel-axis theorem).
Matrix3 UnitInertiaAt(const Vector3& d) { return InertiaOfSecondMoment(d * d.transpose()); }

}  // namespace

MassProperties MeshMassProperties(const TriangleMesh& mesh, double density_kg_per_m3) {
  if (mesh.triangles.empty()) return {};
  // sum relative to a point of the mesh: far from the origin, large terms would cancel and lose digits
  const Vector3 origin = mesh.vertices_m[mesh.triangles.front()[0]];
  double six_volumes = 0.0;
  Vector3 first_moment = Vector3::Zero();
  Matrix3 second_moment = Matrix3::Zero();
  for (const auto& t : mesh.triangles) {
    const Vector3 a = mesh.vertices_m[t[0]] - origin, b = mesh.vertices_m[t[1]] - origin,
                  c = mesh.vertices_m[t[2]] - origin;
    const double six_v = a.dot(b.cross(c));
    const Vector3 sum = a + b + c;  // sum of the corners; the fourth corner is the origin, and adds nothing
    six_volumes += six_v;
    first_moment += six_v * sum;
    second_moment +=
        six_v * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
  }
  const double volume = six_volumes / 6.0;
  if (volume == 0.0) return {};
  const Vector3 center = first_moment / (24.0 * volume);
  const Matrix3 about_center = second_moment / 120.0 - volume * center * center.transpose();
  return {.volume_m3 = volume,
          .mass_kg = density_kg_per_m3 * volume,
          .center_of_mass_m = origin + center,
          .inertia_kg_m2 = density_kg_per_m3 * InertiaOfSecondMoment(about_center)};
}

MassProperties MeshMassProperties(const LoadedMesh& loaded, std::span<const double> densities_kg_per_m3) {
  if (densities_kg_per_m3.empty())
    throw std::invalid_argument("mass properties: found no density, accepted one and more");
  const auto density = [&](std::size_t shell) {
    return densities_kg_per_m3[std::min(shell, densities_kg_per_m3.size() - 1)];
  };
  std::vector<MassProperties> bodies{MeshMassProperties(loaded.mesh, density(0))};
  for (std::size_t i = 0; i < loaded.regions.size(); ++i) {
    const MeshRegion& region = loaded.regions[i];
    const std::size_t around = region.parent ? *region.parent + 1 : 0;
    // use the difference of densities, because the surrounding tissue already contains this volume with its
    // own density
    bodies.push_back(MeshMassProperties(region.mesh, density(i + 1) - density(around)));
    bodies.back().volume_m3 = 0.0;
  }
  return Combine(bodies);
}

MassProperties PointMassProperties(std::span<const MassPoint> points, std::span<const Material> materials) {
  MassProperties total;
  Vector3 first_moment = Vector3::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].material >= materials.size())
      throw std::invalid_argument(fmt::format("mass properties: point {}: found material {}, accepted 0 … {}",
                                              i, points[i].material, materials.size() - 1));
    const double mass = materials[points[i].material].density_kg_per_m3 * points[i].volume_m3;
    total.volume_m3 += points[i].volume_m3;
    total.mass_kg += mass;
    first_moment += mass * Vector3(points[i].p_m);
  }
  if (total.mass_kg == 0.0) return total;
  total.center_of_mass_m = first_moment / total.mass_kg;
  for (const MassPoint& point : points) {
    const double mass = materials[point.material].density_kg_per_m3 * point.volume_m3;
    const double radius = std::cbrt(point.volume_m3 * 3.0 / (4.0 * std::numbers::pi));
    total.inertia_kg_m2 += mass * UnitInertiaAt(Vector3(point.p_m) - total.center_of_mass_m) +
                           0.4 * mass * radius * radius * Matrix3::Identity();
  }
  return total;
}

MassProperties Combine(std::span<const MassProperties> bodies) {
  MassProperties total;
  Vector3 first_moment = Vector3::Zero();
  for (const MassProperties& body : bodies) {
    total.volume_m3 += body.volume_m3;
    total.mass_kg += body.mass_kg;
    first_moment += body.mass_kg * body.center_of_mass_m;
  }
  if (total.mass_kg == 0.0) return total;
  total.center_of_mass_m = first_moment / total.mass_kg;
  for (const MassProperties& body : bodies)
    total.inertia_kg_m2 +=
        body.inertia_kg_m2 + body.mass_kg * UnitInertiaAt(body.center_of_mass_m - total.center_of_mass_m);
  return total;
}

}  // namespace osteon::simulation
