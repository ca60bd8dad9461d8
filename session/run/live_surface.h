#pragma once

#include <functional>
#include <memory>

#include "session/procedure/procedure_session.h"
#include "session/setup/cell_setup.h"
#include "simulation/surface/surface_thread.h"

namespace osteon::session {

/// Starts the thread that updates the surface of the carved bone: that of the bone's solid or, if the solid
/// is not known, of its balls.
/// @param setup, sink  must outlive the thread
/// @param session  a procedure, whose earlier passes are carved first and can be undone; must outlive the
///   thread; null: none
/// @param is_watched  SurfaceThreadParams::is_watched
[[nodiscard]] std::unique_ptr<surface::SurfaceThread> StartSurface(const CellSetup& setup,
                                                                   const ProcedureSession* session,
                                                                   std::function<bool()> is_watched,
                                                                   surface::SurfaceSink& sink);

}  // namespace osteon::session
