#include "config/reading/load_scenario.h"

#include <array>

#include <fmt/format.h>

#include "config/reading/strict/reader.h"

namespace osteon::config {
namespace {

void ReadTolerances(Reader section, TraceTolerances& tolerances) {
  const auto read = [&](const char* key, double& value, double max) {
    if (section.Has(key)) value = section.Number(key, 0, max);
  };
  read("position_um", tolerances.position_m, 1e4);
  read("angle_rad", tolerances.angle_rad, 1);
  read("force_N", tolerances.force_N, 200);
  read("torque_Nm", tolerances.torque_Nm, 50);
  read("spindle_rad_per_s", tolerances.speed_rad_per_s, 100);
  read("volume_mm3", tolerances.volume_m3, 1e4);
  read("energy_J", tolerances.energy_J, 10);
  read("share_ratio", tolerances.share, 1);
  read("event_ms", tolerances.event_s, 1000);
}

}  // namespace

ScenarioConfig LoadScenario(const std::filesystem::path& file) {
  Reader reader = Reader::Load(file);
  ScenarioConfig scenario;
  scenario.file = file;
  scenario.name = file.stem().string();
  scenario.shows = reader.Text("shows");
  scenario.cell = reader.File("cell", "cells");
  scenario.engine =
      std::array{ScenarioEngine::kPlane, ScenarioEngine::kReference, ScenarioEngine::kVulkan}.at(
          reader.Choice("engine", {"plane", "reference", "vulkan"}));
  scenario.seconds = reader.Number("duration_s", 0.1, 60);
  scenario.sample_s = reader.Number("sample_ms", 1, 1000);
  if (reader.Has("frame_ms")) scenario.frame_s = reader.Number("frame_ms", 1, 100);
  if (reader.Has("packing")) scenario.planned = reader.Choice("packing", {"scene", "planned"}) == 1;
  if (reader.Has("recovery_count")) scenario.recoveries = reader.WholeNumber("recovery_count", 0, 100);
  if (reader.Has("pause_s")) scenario.pause_s = reader.Number("pause_s", 0, 60);
  if (reader.Has("resume_s")) scenario.resume_s = reader.Number("resume_s", 0, 60);
  if (reader.Has("plan")) scenario.plan = reader.File("plan", "plans");
  if (reader.Has("guidance_ratio")) scenario.guidance = reader.Number("guidance_ratio", 0, 1);
  if (reader.Has("tolerances")) ReadTolerances(reader.Section("tolerances"), scenario.tolerances);
  static_cast<void>(reader.Has(kOverridesKey));  // marks this key as known; the overlay reads its content
  reader.Finish();

  if (scenario.resume_s && !(scenario.pause_s && *scenario.pause_s < *scenario.resume_s))
    reader.Refuse("resume_s", fmt::format("found {:.10g}, accepted more than pause_s, which has to be there",
                                          *scenario.resume_s));
  if (scenario.guidance && scenario.plan.empty())
    reader.Refuse("guidance_ratio", "found without a plan, accepted with `plan` beside it");
  return scenario;
}

}  // namespace osteon::config
