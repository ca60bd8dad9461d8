#include "control/stability/stabilisers.h"

namespace osteon::control {

void Validate(const StabiliserParams& params) {
  Validate(params.age_governor);
  Validate(params.passivity);
  Validate(params.energy_tank);
}

Stabilisers::Stabilisers(const StabiliserParams& params, const StabilisedLaw& law, double period_s)
    : law_(law),
      governor_(params.age_governor, period_s),
      tank_(params.energy_tank, period_s),
      passivity_(params.passivity, law.work, period_s, law.max_damping_Ns_per_m) {}

void Stabilisers::Reset() OSTEON_RT {
  governor_.Reset();
  tank_.Reset();
  passivity_.Reset();
}

void Stabilisers::SetLaw(const StabilisedLaw& law) OSTEON_RT {
  law_.damping = law.damping;
  passivity_.SetMaxDamping(law.max_damping_Ns_per_m);
}

// Subtracts from a coupling wrench the part of a hand-over that the tank cannot pay for.
Wrench Stabilisers::RemoveUnpaidHandOver(const CouplingOutput& coupling,
                                         const Wrench& F_T_W) const OSTEON_RT {
  const double unpaid = 1.0 - tank_.hand_over_scale();
  if (unpaid == 0.0) return F_T_W;
  return {.f = F_T_W.f - unpaid * coupling.F_hand_over_T_W.f,
          .t = F_T_W.t - unpaid * coupling.F_hand_over_T_W.t};
}

Wrench Stabilisers::ScaleCoupling(const CouplingOutput& coupling, const Pose& X_WT,
                                  const Twist& V_WT) OSTEON_RT {
  governor_.Step(
      coupling, X_WT.linear(), law_.damping,
      {.pose_s = law_.pose_age_s, .planes_s = coupling.age_s + coupling.hand_over_s + law_.pose_age_s});
  const double scale = governor_.wrench_scale() * tank_.Step(coupling, X_WT, V_WT, governor_.wrench_scale());
  const Wrench F_T_W = RemoveUnpaidHandOver(coupling, coupling.F_T_W);
  return {.f = scale * F_T_W.f, .t = scale * F_T_W.t};
}

Wrench Stabilisers::AddPassivityDamping(const CouplingOutput& coupling, const Pose& X_WT, const Twist& V_WT,
                                        const safety::LimitedWrench& limited,
                                        const safety::WrenchLimiter& limiter) OSTEON_RT {
  const double scale = governor_.wrench_scale() * tank_.scale();
  const double rendered = scale * limited.share;
  const Wrench F_contact_T_W = RemoveUnpaidHandOver(coupling, coupling.F_contact_T_W);
  const Wrench damping =
      passivity_.Step({.F_T_W = {.f = rendered * F_contact_T_W.f, .t = rendered * F_contact_T_W.t},
                       .potential_J = scale * coupling.potential_J,
                       .paid_J = tank_.paid_J(),
                       .contact = coupling.active_count > 0,
                       .X_WT = X_WT,
                       .V_WT = V_WT});
  if (!passivity_.acted()) return limited.F;
  return limiter.Limit({.f = limited.F.f + damping.f, .t = limited.F.t + damping.t}).F;
}

void Stabilisers::FillRecord(TickRecord& record) const OSTEON_RT {
  record.age_damping_factor = governor_.damping_factor();
  record.age_wrench_share = governor_.wrench_scale();
  record.passivity_energy_J = passivity_.energy_J();
  record.passivity_damping_Ns_per_m = passivity_.damping_Ns_per_m();
  record.tank_J = tank_.energy_J();
  record.tank_share = tank_.scale();
}

}  // namespace osteon::control
