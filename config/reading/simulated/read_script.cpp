#include "config/reading/simulated/read_script.h"

#include <stdexcept>

#include <fmt/format.h>

namespace osteon::config {
namespace {

// Reads the keys that every kind of script has.
template <typename Params>
void ReadCommon(Reader& section, Params& script) {
  script.seconds = section.Number("duration_s", 0.1, 36000);
  script.push_force_N = section.Number("push_force_N", 0.1, 500);
  script.approach_force_N = section.Number("approach_force_N", 0.05, 200);
  script.retract_height_m = section.Number("retract_height_mm", 0, 300);
  script.max_target_m_per_s = section.Number("max_target_mm_per_s", 1, 1000);
}

hil::ReamingScriptParams ReadReaming(Reader& section) {
  hil::ReamingScriptParams script;
  ReadCommon(section, script);
  script.full_force_depth_m = section.Number("full_force_depth_mm", 0, 500);
  script.tilt_rad = section.Number("tilt_deg", 0, 28);
  script.whirl_period_s = section.Number("whirl_period_s", 0.2, 60);
  script.max_tilt_rad_per_s = section.Number("max_tilt_deg_per_s", 1, 360);
  return script;
}

hil::DrillingScriptParams ReadDrilling(Reader& section) {
  hil::DrillingScriptParams script;
  ReadCommon(section, script);
  script.depth_m = section.Number("full_force_depth_mm", 0.1, 500);
  script.pecks = section.WholeNumber("peck_count", 1, 50);
  script.peck_height_m = section.Number("peck_height_mm", 0, 100);
  return script;
}

hil::OpeningScriptParams ReadOpening(Reader& section) {
  hil::OpeningScriptParams script;
  ReadCommon(section, script);
  script.depth_m = section.Number("full_force_depth_mm", 0.1, 500);
  script.site_radius_m = section.Number("opening_radius_mm", 0.1, 100);
  script.loop_period_s = section.Number("loop_period_s", 0.05, 60);
  script.turns = section.WholeNumber("turn_count", 1, 50);
  return script;
}

}  // namespace

hil::ScriptParams ReadScript(Reader section) {
  switch (section.Choice("kind", {"reaming", "drilling", "opening"})) {
    case 1:
      return ReadDrilling(section);
    case 2:
      return ReadOpening(section);
    default:
      return ReadReaming(section);
  }
}

void CheckScript(const Reader& section, const hil::ScriptParams& script, const Reader& hand,
                 double hand_max_force_N) {
  std::visit(
      [&](const auto& s) {
        if (s.push_force_N >= hand_max_force_N)
          hand.Refuse("max_force_N",
                      fmt::format("found {:.10g}, accepted more than the script's push_force_N "
                                  "({:.10g})",
                                  hand_max_force_N, s.push_force_N));
        if (s.approach_force_N >= s.push_force_N)
          section.Refuse("push_force_N", fmt::format("found {:.10g}, accepted more than approach_force_N "
                                                     "({:.10g})",
                                                     s.push_force_N, s.approach_force_N));
      },
      script);
  try {
    static_cast<void>(hil::MakeScript(script));
  } catch (const std::invalid_argument& error) {
    section.Refuse("kind", error.what());
  }
}

}  // namespace osteon::config
