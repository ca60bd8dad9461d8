#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "simulation/mesh/triangle_mesh.h"
#include "simulation/tools/tool_kinds.h"

namespace osteon::simulation {

/// Parameters that turn a mesh into a tool.
struct MeshToolParams {
  std::string name{"mesh tool"};
  /// The part of the surface between these two heights z in T cuts; the rest only touches.
  double cutting_back_z_m{-1.0}, cutting_front_z_m{0.0};
  double density_kg_per_m3{7900.0};
  BallParams balls{};
  HolderParams holder{};  ///< the holder begins at the mesh's hindmost point
};

/// Largest accepted |z| of the mesh's foremost point, which should be at z = 0.
inline constexpr double kApexTolerance_m = 0.1e-3;

/// Makes a tool from a closed mesh in T. Balls are fitted to the surface (FitTool) at points that are spread
/// by area. Since no point lies exactly on a sharp edge, the gap there may be a fifth larger than accepted,
/// and at a corner even more. The mass is that of the mesh (MeshMassProperties) and the holder.
/// @pre CheckMesh accepts the mesh.
/// @throws std::invalid_argument naming the figure and what is accepted: also if the mesh's foremost point is
///   not at z = 0, no part of the surface cuts, or the balls do not suffice for the gaps.
[[nodiscard]] BuiltTool MakeMeshTool(const TriangleMesh& mesh, const MeshToolParams& params);

/// Points spread evenly over a mesh's surface by area.
/// @param seed  selects the points
[[nodiscard]] std::vector<SurfaceSample> SampleMesh(const TriangleMesh& mesh, const MeshToolParams& params,
                                                    std::size_t count, std::uint64_t seed);

}  // namespace osteon::simulation
