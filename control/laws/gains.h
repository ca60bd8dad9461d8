#pragma once

#include "base/marker.h"
#include "control/coupling/virtual_coupling.h"
#include "control/laws/admittance_law.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Gains that may change while the loop renders. Plain data; read the laws' defaults with GainsOf.
struct Gains {
  /// mass and inertia of the virtual tool at its centre, for each axis of T
  PlainVector3 mass_kg, inertia_kg_m2;
  PlainVector3 damping_Ns_per_m, damping_Nms_per_rad;
  double dead_zone_N{0.0}, dead_zone_Nm{0.0};
  double max_stiffness_N_per_m{0.0}, coupling_damping_Ns_per_m{0.0}, damping_share{0.0};
};

/// Visits every gain with its name, unit and value, in a fixed order: visit(name, axis, unit, value&).
template <class AnyGains, class Visit>
void VisitGains(AnyGains& gains, Visit&& visit) {
  const auto triple = [&](const char* name, const char* unit, auto& v) {
    visit(name, "x", unit, v.x);
    visit(name, "y", unit, v.y);
    visit(name, "z", unit, v.z);
  };
  triple("mass", "kg", gains.mass_kg);
  triple("inertia", "kg_m2", gains.inertia_kg_m2);
  triple("damping", "Ns_per_m", gains.damping_Ns_per_m);
  triple("damping", "Nms_per_rad", gains.damping_Nms_per_rad);
  visit("dead_zone", "", "N", gains.dead_zone_N);
  visit("dead_zone", "", "Nm", gains.dead_zone_Nm);
  visit("coupling_stiffness", "", "N_per_m", gains.max_stiffness_N_per_m);
  visit("coupling_damping", "", "Ns_per_m", gains.coupling_damping_Ns_per_m);
  visit("coupling_damping_share", "", "", gains.damping_share);
}
/// Number of gains that VisitGains visits.
inline constexpr std::size_t kGainCount = 17;

/// Reads the gains from the laws' parameters.
[[nodiscard]] Gains GainsOf(const AdmittanceParams& admittance, const CouplingParams& coupling) OSTEON_RT;
/// Writes the gains into the laws' parameters; other parameters are unchanged.
void ApplyGains(const Gains& gains, AdmittanceParams& admittance, CouplingParams& coupling) OSTEON_RT;

/// @throws std::invalid_argument naming the field, the value and what is accepted: the same ranges as in
///   Validate of the laws' parameters
void Validate(const Gains& gains);

}  // namespace osteon::control
