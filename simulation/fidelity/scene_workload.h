#pragma once

#include "simulation/bone/scenes.h"
#include "simulation/fidelity/removal_error.h"
#include "simulation/fidelity/workloads.h"

// A scene's own cut as a workload: a plan of the scene's fineness is measured with it.

namespace osteon::simulation {

/// How a scene's cut is played.
struct SceneWorkloadParams {
  double rate_hz{1000.0};
  std::size_t cut_frames{500};  ///< requested number; a frame moves the tool 0.02 … 0.2 mm
  double offset_m{0.3e-3};      ///< distance that the tool is then pressed off its own path
};

/// Makes the workload of a scene's cut. With the spindle on, the tool moves where the scene is to be cut.
/// Then, with the spindle off, it is pressed off the path's end in a circle 20 degrees from straight ahead.
///
///     cup    the head's centre down the cup's axis, its apex to packing.cup_depth_m below the floor
///     path   the head's centre along the zone's path
///
/// Materials are the scene's without friction; `task` is kScene, and there are no exact forces.
/// @throws std::invalid_argument where the zone is neither cup nor path, or the tool cuts nothing.
[[nodiscard]] CutWorkload MakeSceneWorkload(const SceneSolid& solid, const SceneParams& scene,
                                            const Tool& tool, const CuttingParams& cutting,
                                            const SceneWorkloadParams& params = {});

/// The shape of the same cut for the closed forms. The wall is the shortest part of the path that leads
/// through bone and out again, which is a plate's thickness.
[[nodiscard]] CutShape ShapeOfCut(const CutWorkload& work, const SceneParams& scene);

}  // namespace osteon::simulation
