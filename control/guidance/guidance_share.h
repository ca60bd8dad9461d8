#pragma once

#include "base/marker.h"
#include "control/guidance/guidance_field.h"
#include "kinematics/spatial.h"
#include "safety/limits.h"

namespace osteon::control {

/// The share of the guidance that is rendered, and the energy that the guidance has given to the tool.
///
/// In each tick the share sigma is the greatest in [0, min(gain, sigma_before + dt / 0.1 s)] with
///
///     |F_coupling + F_depth limit + sigma F| <= the cell's limit, and the arm's torques hold it
///     E_before + (F_before + sigma F)·dx / 2 + sigma U <= 0
///
/// F_before is the wrench that was rendered in the last tick, dx the tool's motion since then. E is the
/// trapezoidal energy that the guidance has given; below zero it was taken. So the energy that is stored,
/// sigma U, was always taken from the hand before, whatever the limits did to sigma in between. What was
/// taken is forgotten beyond sigma U + 0.05 J, so that it can't be given back much later. At U = 0 nothing is
/// stored, and sigma may rise at once. Guidance that is switched on outside its corridor stays at sigma = 0
/// until the tool has been inside.
class GuidanceShare {
 public:
  /// Forgets energy, share and motion.
  void Reset() OSTEON_RT { *this = {}; }

  /// First half of a tick. @returns the greatest share by gain, ramp and energy
  /// @param max_share  gain, or less while the contact model is old; 0 … 1
  [[nodiscard]] double Propose(const GuidanceField& field, const Pose& X_WT, double max_share,
                               double dt_s) OSTEON_RT;
  /// Second half: sets the share that the limits of force and torque leave, at most the proposed one.
  void Accept(double share) OSTEON_RT;
  /// A later limit passed only this share, 0 … 1, of the accepted wrench.
  void ScaleRendered(double share) OSTEON_RT { Accept(share * share_); }

  [[nodiscard]] double share() const OSTEON_RT { return share_; }
  [[nodiscard]] double energy_J() const OSTEON_RT { return energy_J_; }
  /// The rendered wrench: share × field.
  [[nodiscard]] const Wrench& F_T_W() const OSTEON_RT { return F_T_W_; }

 private:
  // between ticks
  double share_{0.0}, energy_J_{0.0};
  Wrench F_T_W_;
  Pose X_WT_{Pose::Identity()};
  bool has_pose_{false};
  // of this tick: its field, the energy without its wrench, the work of its whole wrench
  Wrench F_field_T_W_;
  double potential_J_{0.0}, energy_before_J_{0.0}, work_J_{0.0};
};

/// The greatest share in [0, max_share] with which `guidance` and another wrench stay within a limiter's
/// force and torque, by the closed form; 0 if the other one does not by itself.
[[nodiscard]] double ShareWithin(const safety::WrenchLimiter& limiter, const Wrench& other,
                                 const Wrench& guidance, double max_share) OSTEON_RT;

/// The greatest share in [0, max_share] that `fits`, within max_share / 1024: ten halvings where the whole
/// does not. The shares that fit must be an interval from 0; if 0 itself does not fit, the result is 0.
template <class Fits>
[[nodiscard]] double GreatestFittingShare(double max_share, const Fits& fits) OSTEON_RT {
  if (!(max_share > 0.0) || fits(max_share)) return max_share;
  double low = 0.0, high = max_share;
  for (int i = 0; i < 10; ++i) {
    const double middle = 0.5 * (low + high);
    (fits(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace osteon::control
