#pragma once

#include <functional>
#include <memory>

#include "session/procedure/procedure_session.h"
#include "session/setup/cell_setup.h"
#include "simulation/surface/surface_thread.h"

namespace osteon::session {

/// Starts a thread that makes the carved bone's surface while frames are pushed: of the solid, or, where it
/// is not known, of the balls.
/// @param setup, sink  outlive the thread
/// @param session  of a procedure: its first tool, what it has cut before, passes that may be taken back; it
///   outlives the thread; null: none
/// @param is_watched  SurfaceThreadParams::is_watched
[[nodiscard]] std::unique_ptr<surface::SurfaceThread> StartSurface(const CellSetup& setup,
                                                                   const ProcedureSession* session,
                                                                   std::function<bool()> is_watched,
                                                                   surface::SurfaceSink& sink);

}  // namespace osteon::session
