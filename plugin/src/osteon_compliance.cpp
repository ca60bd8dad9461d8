#include "plugin/src/handles.h"

// The functions of osteon.h for compliance of tool, soft tissue and bone mount.

using osteon::plugin::CheckPointer;
using osteon::plugin::Guarded;
using osteon::plugin::Session;
using osteon::plugin::WithSession;

OsteonResult osteon_compliance_params_init(uint32_t abi, OsteonComplianceParams* params) {
  return osteon::plugin::Init(
      abi, params, +[](OsteonComplianceParams* p) {
        *p = {.tool = 0,
              .layer = 0,
              .mount = 0,
              .reserved = 0,
              .period_s = 0.001,
              .push_N = 60.0,
              .noticed_m = 0.1e-3,
              .mount_point_m = {0.0, 0.0, 0.0},
              .mount_mass_kg = 12.0,
              .mount_inertia_kg_m2 = {0.12, 0.12, 0.12},
              .mount_stiffness_N_per_m = {47.4e3, 47.4e3, 47.4e3},
              .mount_stiffness_Nm_per_rad = {2e3, 2e3, 2e3},
              .mount_damping_ratio = 0.05,
              .mount_creep_N_per_m = 0.0,
              .mount_creep_s = 20.0};
      });
}

OsteonResult osteon_session_set_compliance(uint32_t abi, OsteonSession* session,
                                           const OsteonComplianceParams* params) {
  const OsteonResult fits = Guarded([&] { osteon::plugin::CheckAbi(abi); });
  if (fits != OSTEON_OK) return fits;
  return WithSession(session, [&](Session& s) { s.SetCompliance(params); });
}

OsteonResult osteon_session_deflection(OsteonSession* session, OsteonDeflection* deflection) {
  return WithSession(session, [&](Session& s) {
    CheckPointer(deflection, "deflection");
    *deflection = s.Deflection();
  });
}
