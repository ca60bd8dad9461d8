#include "control/laws/gains.h"

namespace osteon::control {

Gains GainsOf(const AdmittanceParams& admittance, const CouplingParams& coupling) OSTEON_RT {
  return {.mass_kg = admittance.mass_kg,
          .inertia_kg_m2 = admittance.inertia_kg_m2,
          .damping_Ns_per_m = admittance.damping_Ns_per_m,
          .damping_Nms_per_rad = admittance.damping_Nms_per_rad,
          .dead_zone_N = admittance.dead_zone_N,
          .dead_zone_Nm = admittance.dead_zone_Nm,
          .max_stiffness_N_per_m = coupling.max_stiffness_N_per_m,
          .coupling_damping_Ns_per_m = coupling.damping_Ns_per_m,
          .damping_share = coupling.damping_share};
}

void ApplyGains(const Gains& gains, AdmittanceParams& admittance, CouplingParams& coupling) OSTEON_RT {
  admittance.mass_kg = gains.mass_kg;
  admittance.inertia_kg_m2 = gains.inertia_kg_m2;
  admittance.damping_Ns_per_m = gains.damping_Ns_per_m;
  admittance.damping_Nms_per_rad = gains.damping_Nms_per_rad;
  admittance.dead_zone_N = gains.dead_zone_N;
  admittance.dead_zone_Nm = gains.dead_zone_Nm;
  coupling.max_stiffness_N_per_m = gains.max_stiffness_N_per_m;
  coupling.damping_Ns_per_m = gains.coupling_damping_Ns_per_m;
  coupling.damping_share = gains.damping_share;
}

void Validate(const Gains& gains) {
  AdmittanceParams admittance;
  CouplingParams coupling;
  ApplyGains(gains, admittance, coupling);
  Validate(admittance);
  Validate(coupling);
}

}  // namespace osteon::control
