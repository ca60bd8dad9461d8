#pragma once

#include "simulation/fidelity/removal_error.h"
#include "simulation/metrics/workloads.h"
#include "simulation/scenes.h"

// A scene's own cut, played to an engine: what a plan of its fineness is measured on.

namespace osteon::simulation {

/// How a scene's cut is played.
struct SceneWorkloadParams {
  double rate_hz{1000.0};
  std::size_t cut_frames{500};  ///< wanted; a frame goes .02 … .2 mm
  double offset_m{0.3e-3};      ///< by which the tool is then pressed off its own way
};

/// The tool goes where the scene says that it is cut, spindle on, and then, spindle off, is pressed off the
/// way's end in a circle 20 degrees from straight ahead.
///
///     cup    the head's centre down the cup's axis, its apex to packing.cup_depth_m below the floor
///     path   the head's centre along the zone's path
///
/// Materials are the scene's without friction; `task` is kScene, and no exact forces are told.
/// @throws std::invalid_argument where the zone is neither cup nor path, or the tool cuts nothing.
[[nodiscard]] CutWorkload MakeSceneWorkload(const SceneSolid& solid, const SceneParams& scene,
                                            const Tool& tool, const CuttingParams& cutting,
                                            const SceneWorkloadParams& params = {});

/// The same cut as the closed forms see it. Wall: the shortest part of the way that leads through bone and
/// out again, which is a plate's thickness.
[[nodiscard]] CutShape ShapeOfCut(const CutWorkload& work, const SceneParams& scene);

}  // namespace osteon::simulation
