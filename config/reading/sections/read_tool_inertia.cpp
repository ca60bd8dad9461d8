#include "config/reading/sections/read_tool_inertia.h"

namespace osteon::config {

void ReadToolInertia(Reader& section, control::ForceSensorParams& sensor) {
  if (section.Has("inertia_share_ratio")) sensor.inertia_share = section.Number("inertia_share_ratio", 0, 1);
  if (section.Has("acceleration_hz")) sensor.acceleration_hz = section.Number("acceleration_hz", 1, 200);
}

}  // namespace osteon::config
