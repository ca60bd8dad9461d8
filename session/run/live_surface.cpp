#include "session/run/live_surface.h"

#include <utility>

#include "session/procedure/bone_history.h"
#include "simulation/surface/bone_solid.h"

namespace osteon::session {

std::unique_ptr<surface::SurfaceThread> StartSurface(const CellSetup& setup, const ProcedureSession* session,
                                                     std::function<bool()> is_watched,
                                                     surface::SurfaceSink& sink) {
  const simulation::Tool& tool = setup.config.tool.tool;
  const float voxel_mm = surface::VoxelFor(tool);
  surface::SurfaceThreadParams params;
  params.make_solid = [&setup, voxel_mm] {
    return surface::FieldOfBone(setup.solid.get(), setup.bone, voxel_mm);
  };
  params.is_watched = std::move(is_watched);
  if (setup.solid) params.material = surface::TissueOf(setup.solid);
  if (session) {
    params.carve_earlier = HistoryOf(*session, setup.X_WG).carve_earlier;
    params.keeps_batches = true;
  }
  const simulation::Tool& first_tool =
      session ? session->tools()[static_cast<std::size_t>(session->first_tool())].tool : tool;
  return std::make_unique<surface::SurfaceThread>(first_tool, setup.X_WG, std::move(params), sink);
}

}  // namespace osteon::session
