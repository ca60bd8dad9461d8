#include "config/reading/simulated/read_operator.h"

#include <cmath>

#include <fmt/format.h>

namespace osteon::config {
namespace {

// Reads an incident in which something holds the tool: the keys that grip step and clamp share.
// @param bound_factor  factor on the upper bounds of a hand's stiffness and damping
template <typename Held>
Held ReadHeld(Reader& section, double bound_factor) {
  Held held;
  held.begin_s = section.Number("at_s", 0, 36000);
  if (section.Has("until_s")) held.end_s = section.Number("until_s", 0, 36000);
  held.spring.stiffness_N_per_m = section.Number("stiffness_N_per_m", 50, 50000 * bound_factor);
  held.spring.damping_Ns_per_m = section.Number("damping_Ns_per_m", 0.1, 1000 * bound_factor);
  held.spring.stiffness_Nm_per_rad = section.Number("stiffness_Nm_per_rad", 0.1, 1000 * bound_factor);
  held.spring.damping_Nms_per_rad = section.Number("damping_Nms_per_rad", 0.001, 100 * bound_factor);
  held.return_s = section.Number("return_ms", 1, 10000);
  section.Finish();
  if (held.end_s <= held.begin_s)
    section.Refuse("until_s",
                   fmt::format("found {:.10g}, accepted more than at_s ({:.10g})", held.end_s, held.begin_s));
  return held;
}

// Reads a release in which the hand jerks first. @param max_force_N  of the hand; bounds the jerk
hil::StartledRelease ReadRelease(Reader& section, double max_force_N) {
  hil::StartledRelease release;
  release.begin_s = section.Number("at_s", 0, 36000);
  release.jerk_N = section.Number("jerk_N", 0, 500);
  release.jerk_s = section.Number("jerk_ms", 1, 1000);
  release.jerk_C = section.Direction("jerk_axis");
  release.release_s = section.Number("release_ms", 1, 1000);
  if (section.Has("away_ms")) release.away_s = section.Number("away_ms", 0, 60000);
  release.return_s = section.Number("return_ms", 1, 10000);
  section.Finish();
  if (release.jerk_N > max_force_N)
    section.Refuse("jerk_N", fmt::format("found {:.10g}, accepted at most the hand's max_force_N ({:.10g})",
                                         release.jerk_N, max_force_N));
  return release;
}

hil::HandIncident ReadIncident(Reader& section, double max_force_N) {
  switch (section.Choice("kind", {"grip_step", "clamp", "startled_release"})) {
    case 1:
      return ReadHeld<hil::RigidClamp>(section, 10.0);
    case 2:
      return ReadRelease(section, max_force_N);
    default:
      return ReadHeld<hil::GripStep>(section, 1.0);
  }
}

// Reads the list `incidents`. Refuses an incident that begins before the previous one is over.
hil::HandIncidents ReadIncidents(Reader& section, double max_force_N) {
  hil::HandIncidents incidents;
  double free_s = 0.0;  // earliest begin of the next incident
  for (Reader& incident_section : section.Sections("incidents", 1, hil::HandIncidents::kMax)) {
    const hil::HandIncident incident = ReadIncident(incident_section, max_force_N);
    const hil::IncidentTimes times = hil::TimesOf(incident);
    if (times.begin_s < free_s)
      incident_section.Refuse(
          "at_s", std::isinf(free_s)
                      ? fmt::format("found {:.10g} after an incident that never ends", times.begin_s)
                      : fmt::format("found {:.10g}, accepted at least {:.10g}, when the one before is over",
                                    times.begin_s, free_s));
    free_s = times.over_s;
    incidents.list.at(incidents.count++) = incident;
  }
  return incidents;
}

}  // namespace

void ReadOperator(Reader section, hil::OperatorHandParams& hand) {
  hand.stiffness_N_per_m = section.Number("stiffness_N_per_m", 50, 50000);
  hand.damping_Ns_per_m = section.Number("damping_Ns_per_m", 0.1, 1000);
  hand.mass_kg = section.Number("mass_kg", 0, 10);
  hand.stiffness_Nm_per_rad = section.Number("stiffness_Nm_per_rad", 0.1, 1000);
  hand.damping_Nms_per_rad = section.Number("damping_Nms_per_rad", 0.001, 100);
  hand.inertia_kgm2 = section.Number("inertia_kg_m2", 0, 1);
  hand.grip_time_s = section.Number("grip_time_ms", 0.5, 500);
  hand.max_force_N = section.Number("max_force_N", 1, 500);
  hand.max_torque_Nm = section.Number("max_torque_Nm", 0.1, 50);
  hand.tremor_N = section.Number("tremor_N", 0, 50);
  hand.tremor_seed = static_cast<std::uint64_t>(section.WholeNumber("tremor_seed", 0, 1'000'000'000));
  if (!section.Has("incidents")) return;
  section.Finish();  // the hand's values must be valid, because the incidents are checked against them
  hand.incidents = ReadIncidents(section, hand.max_force_N);
}

}  // namespace osteon::config
