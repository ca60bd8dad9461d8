#include "simulation/tools/tool_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "base/check_range.h"
#include "simulation/solids/mesh_solid.h"

namespace osteon::simulation {

std::vector<SurfaceSample> SampleMesh(const TriangleMesh& mesh, const MeshToolParams& params,
                                      std::size_t count, std::uint64_t seed) {
  std::vector<double> area_up_to;  // area of all triangles up to and including each
  double total = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3& p = mesh.vertices_m[a];
    total += 0.5 * (mesh.vertices_m[b] - p).cross(mesh.vertices_m[c] - p).norm();
    area_up_to.push_back(total);
  }
  // places on the surface at even steps of area; within a triangle by the R2 sequence (tool_profile.cpp)
  constexpr double kA1 = 0.7548776662466927, kA2 = 0.5698402909980532;
  const auto fraction = [](double x) { return x - std::floor(x); };
  // Start of the sequence. The golden ratio spreads the starts of different seeds.
  const double start = 0.5 + 0.6180339887498949 * static_cast<double>(seed % 1'000'003);
  std::vector<SurfaceSample> samples;
  samples.reserve(count);
  std::size_t triangle = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double at = total * (static_cast<double>(i) + fraction(start)) / static_cast<double>(count);
    while (triangle + 1 < area_up_to.size() && area_up_to[triangle] < at) ++triangle;
    double u = fraction(start + kA1 * static_cast<double>(i)),
           v = fraction(start + kA2 * static_cast<double>(i));
    if (u + v > 1.0)
      u = 1.0 - u, v = 1.0 - v;  // reflects a point of the parallelogram's other half into the triangle
    const auto& [a, b, c] = mesh.triangles[triangle];
    const Vector3 p = mesh.vertices_m[a], ab = mesh.vertices_m[b] - p, ac = mesh.vertices_m[c] - p;
    const Vector3 on = p + u * ab + v * ac;
    const bool cutting = on.z() >= params.cutting_back_z_m && on.z() <= params.cutting_front_z_m;
    samples.push_back({.p_m = on,
                       .normal = ab.cross(ac).normalized(),
                       .gap_m = cutting ? params.balls.cutting_gap_m : params.balls.touching_gap_m,
                       .cutting = cutting});
  }
  return samples;
}

BuiltTool MakeMeshTool(const TriangleMesh& mesh, const MeshToolParams& params) {
  const MeshSolid solid(mesh);
  const Eigen::AlignedBox3d box = solid.Bounds();
  CheckRangeMm(params.name + ": highest point of the mesh in T (the apex)", box.max().z(), -kApexTolerance_m,
               kApexTolerance_m);
  CheckRangeMm(params.name + ": cutting from z", params.cutting_back_z_m, -1.0, params.cutting_front_z_m);
  CheckBallsAndHolder(params.name, params.balls, params.holder, params.density_kg_per_m3);

  const auto sample = [&](std::size_t count) { return SampleMesh(mesh, params, count, 0); };
  const std::vector<SurfaceSample> probes = sample(4000);
  if (std::none_of(probes.begin(), probes.end(), [](const SurfaceSample& s) { return s.cutting; }))
    throw std::invalid_argument(fmt::format(
        "{}: nothing of the mesh lies in z {:.6g} … {:.6g} mm, where it is to cut; it spans {:.6g} … "
        "{:.6g} mm",
        params.name, params.cutting_back_z_m * 1e3, params.cutting_front_z_m * 1e3, box.min().z() * 1e3,
        box.max().z() * 1e3));
  const std::array<MassProperties, 2> bodies{
      MeshMassProperties(mesh, params.density_kg_per_m3),
      CylinderMassProperties(params.holder.radius_m, box.min().z(), box.min().z() - params.holder.length_m,
                             params.holder.density_kg_per_m3)};
  BuiltTool built{.tool = FitBalls(params.name, solid, sample, {}, params.balls.max_count),
                  .length_m = params.holder.length_m - box.min().z()};
  SetMass(Combine(bodies), built.tool);
  return built;
}

}  // namespace osteon::simulation
