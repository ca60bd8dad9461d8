#include "session/run/live_surface.h"

#include <utility>

#include "simulation/surface/bone_solid.h"

namespace osteon::app {

std::unique_ptr<surface::SurfaceThread> StartSurface(const CellSetup& setup, surface::SurfaceSink& sink) {
  const simulation::Tool& tool = setup.config.tool.tool;
  const float voxel_mm = surface::VoxelFor(tool);
  surface::SurfaceThreadParams params;
  if (setup.solid) {
    params.make_solid = [solid = setup.solid, voxel_mm] { return surface::SampleSolid(*solid, voxel_mm); };
    params.material = [solid = setup.solid](surface::Vec3 p_mm) {
      return solid->MaterialAt(1e-3 * Vector3(p_mm.x, p_mm.y, p_mm.z));
    };
  } else {
    params.make_solid = [&bone = setup.bone, voxel_mm] { return surface::UnionOfBalls(bone, voxel_mm); };
  }
  return std::make_unique<surface::SurfaceThread>(tool, setup.X_WG, std::move(params), sink);
}

}  // namespace osteon::app
