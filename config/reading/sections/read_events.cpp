#include "config/reading/sections/read_events.h"

namespace osteon::config {

simulation::SceneEventParams ReadEvents(Reader section) {
  simulation::SceneEventParams events;
  for (Reader& region : section.Sections("regions", 0, 8))
    events.regions.push_back({.name = region.Text("name"), .material = region.Text("material")});
  events.min_wall_m = section.Number("min_wall_mm", 0, 100);
  events.opening_widening = section.Number("opening_widening_ratio", 1, 10);
  events.wall_spacing_m = section.Number("wall_spacing_mm", 0.05, 20);
  return events;
}

}  // namespace osteon::config
