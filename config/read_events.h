#pragma once

#include "config/reader.h"
#include "simulation/scene_events.h"

namespace osteon::config {

/// A section `events`: regions that a cutting ball should not reach or is to reach, and the least wall.
[[nodiscard]] simulation::SceneEventParams ReadEvents(Reader section);

}  // namespace osteon::config
