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
  /// The part of the surface between these two heights z_T cuts, the rest touches.
  double cutting_back_z_m{-1.0}, cutting_front_z_m{0.0};
  double density_kg_per_m3{7900.0};
  BallParams balls{};
  HolderParams holder{};  ///< begins at the mesh's hindmost point
};

/// Largest distance of the mesh's highest point from the plane through T's origin.
inline constexpr double kApexTolerance_m = 0.1e-3;

/// Makes a tool from a closed mesh in T. Balls are fitted to its surface (FitTool) at points spread by area.
/// Near a sharp edge of the mesh, where no point lies, the gap may be a fifth larger, in a corner more. The
/// mass comes from the mesh (MeshMassProperties) and the holder.
/// @pre CheckMesh accepts the mesh.
/// @throws std::invalid_argument naming the figure and what is accepted: also where the mesh's highest point
///   is not at z = 0, where nothing of the surface cuts, and where the balls do not suffice for the gaps.
[[nodiscard]] BuiltTool MakeMeshTool(const TriangleMesh& mesh, const MeshToolParams& params);

/// Points spread evenly over a mesh's surface by area.
/// @param seed  selects the points
[[nodiscard]] std::vector<SurfaceSample> SampleMesh(const TriangleMesh& mesh, const MeshToolParams& params,
                                                    std::size_t count, std::uint64_t seed);

}  // namespace osteon::simulation
