#include "control/stability/energy_tank.h"

#include <algorithm>
#include <cmath>

#include "base/parameter_check.h"
#include "control/laws/twist_parts.h"

namespace osteon::control {
namespace {

constexpr double kMinPivot = 1e-9;  // pivot of the normals' Gram matrix below which a normal counts as
                                    // linearly dependent on the others

using Active = std::array<ActivePlane, CouplingOutput::kMaxActive>;

// Energy of the pressing planes after a small step, if all of them keep pressing.
struct StoredEnergy {
  double potential_J{0.0};
  double work_J{0.0};  // F'·dx: work over the step dx of the force F' after the step
};

// Computes the planes' energy U' and the work F'·dx after a step dx:
//
//     U' = U - F·dx + s/2,   F'·dx = F·dx - s,   s = k (J dx)^T (N^T N)^-1 (J dx)
//
// F is the planes' force before the step, k their stiffness, J maps dx to displacements along the normals N.
// Computed by Gram-Schmidt orthogonalisation of the normals. @param potential_J U, the energy before the step
StoredEnergy EnergyAfterStep(const Active& active, int count, double potential_J, double fade,
                             const Twist& dx) OSTEON_RT {
  std::array<Vector3, 3> normal;
  std::array<double, 3> way_m{};
  int rank = 0;
  double work_J = 0.0, stiffness_N_per_m = 0.0, squares_m2 = 0.0;
  for (int j = 0; j < count; ++j) {
    const ActivePlane& plane = active[static_cast<std::size_t>(j)];
    double out_m = plane.n_W.dot(dx.v + dx.w.cross(plane.lever_W));
    // a single plane releases energy only until the tool leaves it
    if (count == 1) out_m = std::min(out_m, plane.force_N / (fade * plane.stiffness_N_per_m));
    work_J += plane.force_N * out_m;
    if (rank == 3) continue;
    Vector3 n = plane.n_W;
    for (std::size_t i = 0; i < static_cast<std::size_t>(rank); ++i) {
      const double along = normal[i].dot(plane.n_W);
      n -= along * normal[i];
      out_m -= along * way_m[i];
    }
    const double remaining2 = n.squaredNorm();
    if (!(remaining2 > kMinPivot)) continue;
    const double scale = 1.0 / std::sqrt(remaining2);
    normal[static_cast<std::size_t>(rank)] = scale * n;
    way_m[static_cast<std::size_t>(rank)] = scale * out_m;
    squares_m2 += scale * scale * out_m * out_m;
    stiffness_N_per_m = std::max(stiffness_N_per_m, plane.stiffness_N_per_m);
    ++rank;
  }
  const double fall_J = fade * stiffness_N_per_m * squares_m2;
  return {.potential_J = std::max(0.0, potential_J - work_J + 0.5 * fall_J), .work_J = work_J - fall_J};
}

// Wrench of the active planes' springs on T at To, in W. It includes the coupling's fade, but neither damping
// nor hand-over.
Wrench SpringOf(const CouplingOutput& coupling) OSTEON_RT {
  Wrench F;
  for (int j = 0; j < coupling.active_planes; ++j) {
    const ActivePlane& plane = coupling.active[static_cast<std::size_t>(j)];
    F.f += plane.force_N * plane.n_W;
    F.t += plane.lever_W.cross(plane.force_N * plane.n_W);
  }
  return F;
}

}  // namespace

void Validate(const EnergyTankParams& params) {
  const base::ParameterCheck require("energy tank ");
  require("cap_J", params.cap_J, 0.0, 1000.0);
  require("ramp_s", params.ramp_s, 0.05, 10.0);
}

EnergyTank::EnergyTank(const EnergyTankParams& params, double period_s)
    : params_(params), period_s_(period_s), tank_J_(params.cap_J) {
  Validate(params);
}

void EnergyTank::Reset() OSTEON_RT {
  tank_J_ = params_.cap_J;
  scale_ = 1.0;
  paid_J_ = 0.0;
  begun_ = false;
  active_planes_ = 0;
  potential_J_ = fade_ = gain_ = 0.0;
  hand_over_scale_ = 1.0;
  hand_over_T_W_ = {};
}

double EnergyTank::Step(const CouplingOutput& coupling, const Pose& X_WT, const Twist& V_WT,
                        double gain) OSTEON_RT {
  if (!params_.acts) return 1.0;
  const double before_J = tank_J_;

  // energy of the previous tick's planes at this pose, and the work that they would have done over the step
  const Twist dx = begun_ ? SmallStep(X_before_, X_WT) : Twist{};
  const Wrench spring = SpringOf(coupling);
  const double work_J = Power(spring, dx);
  StoredEnergy old = EnergyAfterStep(active_, active_planes_, potential_J_, fade_, dx);
  // the planes are the previous tick's, so those touched only now existed then too
  if (!coupling.new_planes && coupling.fade > 0.0) {
    const double faded = std::min(1.0, fade_ / coupling.fade);
    old.potential_J = std::max(old.potential_J, faded * coupling.potential_J);
    old.work_J = faded * work_J;
  }

  // Available energy with the previous tick's gains, and the energy that this tick's planes would store with
  // this tick's gain.
  const double available_J = gain_ * scale_ * (old.potential_J + 0.5 * old.work_J) + tank_J_;
  const double wanted_J = gain * (coupling.potential_J + 0.5 * work_J);
  const double scale = std::min(1.0, scale_ + period_s_ / params_.ramp_s);
  if (coupling.active_planes == 0) {
    scale_ = 1.0;
    tank_J_ = available_J;
  } else if (scale * wanted_J <= available_J) {
    scale_ = scale;
    tank_J_ = available_J - scale * wanted_J;
  } else {
    scale_ = wanted_J > 0.0 ? std::clamp(available_J / wanted_J, 0.0, scale) : scale;
    tank_J_ = 0.0;
  }

  // The force of a hand-over in a tick does half of its work in the step before the tick and half in the step
  // after it.
  const Wrench& added = coupling.F_hand_over_T_W;
  const double added_J = gain * scale_ * Power(added, dx);
  tank_J_ -= 0.5 * Power(hand_over_T_W_, dx);
  hand_over_scale_ = added_J > tank_J_ ? std::max(0.0, tank_J_ / added_J) : 1.0;
  const double rendered = gain * scale_ * hand_over_scale_;
  tank_J_ -= 0.5 * hand_over_scale_ * added_J;
  hand_over_T_W_ = {.f = rendered * added.f, .t = rendered * added.t};

  paid_J_ = std::max(0.0, before_J - std::max(0.0, tank_J_));

  // the energy that the coupling's damping has dissipated goes into the tank
  if (coupling.active_planes > 0) {
    const double dissipated_W =
        Power(spring, V_WT) + Power(added, V_WT) - Power(coupling.F_contact_T_W, V_WT);
    tank_J_ += std::max(0.0, scale_ * gain * period_s_ * dissipated_W);
  }
  tank_J_ = std::clamp(tank_J_, 0.0, params_.cap_J);

  begun_ = true;
  X_before_ = X_WT;
  active_ = coupling.active;
  active_planes_ = coupling.active_planes;
  potential_J_ = coupling.potential_J;
  fade_ = coupling.fade;
  gain_ = gain;
  return scale_;
}

}  // namespace osteon::control
