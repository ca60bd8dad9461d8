#pragma once

#include <functional>
#include <memory>

#include "session/procedure/procedure_session.h"
#include "session/setup/cell_setup.h"
#include "simulation/surface/surface_thread.h"

namespace osteon::session {

/// Starts the thread that updates the surface of the carved bone. The surface comes from the bone's solid or,
/// if the solid is not known, from its balls.
/// @param setup, sink  must outlive the thread
/// @param session  session of a procedure; its earlier passes are carved first, and an undo restores the
/// surface; must outlive the thread; null: none
/// @param is_watched  SurfaceThreadParams::is_watched
[[nodiscard]] std::unique_ptr<surface::SurfaceThread> StartSurface(const CellSetup& setup,
                                                                   const ProcedureSession* session,
                                                                   std::function<bool()> is_watched,
                                                                   surface::SurfaceSink& sink);

}  // namespace osteon::session
