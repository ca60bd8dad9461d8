#pragma once

#include "simulation/bone/scenes.h"
#include "simulation/fidelity/removal_error.h"
#include "simulation/fidelity/workloads.h"

// The cut of a scene as a workload, with which the planned fineness of the scene's packing is measured.

namespace osteon::simulation {

/// Parameters of a scene's cut as a workload.
struct SceneWorkloadParams {
  double rate_hz{1000.0};
  std::size_t cut_frames{500};  ///< wanted number of frames of the cut; each moves the tool 0.02 … 0.2 mm
  double offset_m{0.3e-3};      ///< distance by which the tool is pressed away from its path after the cut
};

/// Makes the workload of a scene's cut. With the spindle on, the tool moves where the scene is to be cut.
/// Then, with the spindle off, the tool is pressed away from the path's end, in a direction 20 degrees from
/// the feed that turns once around it.
///
///     cup    the head's centre down the cup's axis, its apex to packing.cup_depth_m below the floor
///     path   the head's centre along the zone's path
///
/// Materials are the scene's without friction; `task` is kScene, and there are no exact forces.
/// @throws std::invalid_argument if the zone is neither cup nor path, or the tool cuts nothing.
[[nodiscard]] CutWorkload MakeSceneWorkload(const SceneSolid& solid, const SceneParams& scene,
                                            const Tool& tool, const CuttingParams& cutting,
                                            const SceneWorkloadParams& params = {});

/// The shape of the same cut for the closed forms. The wall's thickness is the shortest part of the path that
/// leads through bone and out again.
[[nodiscard]] CutShape ShapeOfCut(const CutWorkload& work, const SceneParams& scene);

}  // namespace osteon::simulation
