#pragma once

#include <memory>

#include "session/setup/cell_setup.h"
#include "simulation/surface/surface_thread.h"

namespace osteon::session {

/// Starts a thread that makes the carved bone's surface while frames are pushed: of the solid, or, where it
/// is not known, of the balls.
/// @param setup, sink  outlive the thread
[[nodiscard]] std::unique_ptr<surface::SurfaceThread> StartSurface(const CellSetup& setup,
                                                                   surface::SurfaceSink& sink);

}  // namespace osteon::session
