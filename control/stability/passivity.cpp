#include "control/stability/passivity.h"

#include <algorithm>

#include "base/parameter_check.h"
#include "control/laws/twist_parts.h"

namespace osteon::control {
namespace {

// Tolerated error of the energy when a contact begins, K v^2 T^2 / 2 at K = 60 N/mm, v = 0.25 m/s and T = 1
// ms: the force of the previous tick is 0 although the tool already moves into the planes.
constexpr double kTouch_J = 2e-3;

}  // namespace

void Validate(const PassivityParams& params) {
  const base::ParameterCheck require("passivity ");
  require("allowance_J", params.allowance_J, 0.0, 10.0);
  require("min_speed_m_per_s", params.min_speed_m_per_s, 1e-5, 1.0);
  require("max_damping_Ns_per_m", params.max_damping_Ns_per_m, 0.0, 1e5);
  require("lever_m", params.lever_m, 1e-3, 1.0);
}

PassivityController::PassivityController(const PassivityParams& params, PortWork work, double period_s,
                                         double max_Ns_per_m)
    : params_(params),
      work_(work),
      period_s_(period_s),
      max_Ns_per_m_(std::min(params.max_damping_Ns_per_m, max_Ns_per_m)) {
  Validate(params);
}

void PassivityController::Reset() OSTEON_RT {
  begun_ = false;
  touched_ = false;
  energy_J_ = 0.0;
  damping_Ns_per_m_ = 0.0;
}

void PassivityController::SetMaxDamping(double max_Ns_per_m) OSTEON_RT {
  max_Ns_per_m_ = std::min(params_.max_damping_Ns_per_m, max_Ns_per_m);
}

void PassivityController::ScaleRendered(double share) OSTEON_RT {
  if (work_ == PortWork::kTrapezoid) energy_J_ -= 0.5 * (1.0 - share) * Power(F_before_, step_before_);
  F_before_ = {.f = share * F_before_.f, .t = share * F_before_.t};
  F_damping_before_ = {.f = share * F_damping_before_.f, .t = share * F_damping_before_.t};
  damping_Ns_per_m_ *= share;
}

Wrench PassivityController::Step(const PortTick& port) OSTEON_RT {
  // energy exchanged since the previous tick
  if (port.contact && !touched_) energy_J_ = -std::min(kTouch_J, params_.allowance_J);
  touched_ = port.contact;
  step_before_ = {};
  if (begun_) {
    const Twist dx = SmallStep(X_before_, port.X_WT);
    step_before_ = dx;
    const double held_J = Power(F_before_, dx);
    energy_J_ += work_ == PortWork::kHeld ? held_J : 0.5 * (held_J + Power(port.F_T_W, dx));
    energy_J_ += Power(F_damping_before_, dx);
  }
  begun_ = true;
  X_before_ = port.X_WT;
  F_before_ = port.F_T_W;
  F_damping_before_ = {};
  damping_Ns_per_m_ = 0.0;
  if (!port.contact) {
    energy_J_ = 0.0;
    return {};
  }
  energy_J_ -= port.paid_J;
  energy_J_ = std::max(energy_J_, -(port.potential_J + params_.allowance_J));

  // damping that dissipates the generated energy
  const double lever2 = params_.lever_m * params_.lever_m;
  const double speed2 = port.V_WT.v.squaredNorm() + lever2 * port.V_WT.w.squaredNorm();
  if (!params_.acts || !(energy_J_ > 0.0) || speed2 < params_.min_speed_m_per_s * params_.min_speed_m_per_s)
    return {};
  damping_Ns_per_m_ = std::min(energy_J_ / (period_s_ * speed2), max_Ns_per_m_);
  F_damping_before_ = {.f = -damping_Ns_per_m_ * port.V_WT.v, .t = -damping_Ns_per_m_ * lever2 * port.V_WT.w};
  return F_damping_before_;
}

}  // namespace osteon::control
