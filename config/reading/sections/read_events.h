#pragma once

#include "config/reading/strict/reader.h"
#include "simulation/bone/scene_events.h"

namespace osteon::config {

/// Reads a section `events`: regions that a cutting ball must not reach or should reach, and the thinnest
/// wall.
[[nodiscard]] simulation::SceneEventParams ReadEvents(Reader section);

}  // namespace osteon::config
