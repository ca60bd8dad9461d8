#include "session/run/live_surface.h"

#include <utility>

#include "simulation/surface/bone_solid.h"

namespace osteon::session {

std::unique_ptr<surface::SurfaceThread> StartSurface(const CellSetup& setup, surface::SurfaceSink& sink) {
  const simulation::Tool& tool = setup.config.tool.tool;
  const float voxel_mm = surface::VoxelFor(tool);
  surface::SurfaceThreadParams params;
  params.make_solid = [&setup, voxel_mm] {
    return surface::FieldOfBone(setup.solid.get(), setup.bone, voxel_mm);
  };
  if (setup.solid) params.material = surface::TissueOf(setup.solid);
  return std::make_unique<surface::SurfaceThread>(tool, setup.X_WG, std::move(params), sink);
}

}  // namespace osteon::session
