#pragma once

#include "base/marker.h"
#include "control/guidance/guidance_field.h"
#include "kinematics/spatial.h"
#include "safety/limits.h"

namespace osteon::control {

/// The scale of the guidance that is rendered, and the energy that the guidance has given to the tool.
///
/// In each tick the scale sigma is the greatest in [0, min(gain, sigma_before + dt / 0.1 s)] with
///
///     |F_coupling + F_depth limit + sigma F| <= the cell's limit, and the arm's torques hold it
///     E_before + (F_before + sigma F)·dx / 2 + sigma U <= 0
///
/// F_before is the wrench that was rendered in the last tick, dx the tool's motion since then. E is the
/// trapezoidal energy that the guidance has given; below zero it was taken. So the energy that is stored,
/// sigma U, was always taken from the hand before, whatever the limits did to sigma in between. Taken
/// energy beyond sigma U + 0.05 J is forgotten, so that it can't be given back much later. At U = 0 nothing
/// is stored, and sigma may rise at once. Guidance that is switched on outside its corridor stays at sigma =
/// 0 until the tool has been inside.
class GuidanceScale {
 public:
  /// Forgets energy, scale and motion.
  void Reset() OSTEON_RT { *this = {}; }

  /// First half of a tick. @returns the greatest scale by gain, ramp and energy
  /// @param max_scale  gain, or less while the contact model is old; 0 … 1
  [[nodiscard]] double ProposeScale(const GuidanceField& field, const Pose& X_WT, double max_scale,
                                    double dt_s) OSTEON_RT;
  /// Second half: sets the scale that the limits of force and torque leave, at most the proposed one.
  void AcceptScale(double scale) OSTEON_RT;
  /// A later limit passed only this scale, 0 … 1, of the accepted wrench.
  void ScaleRendered(double scale) OSTEON_RT { AcceptScale(scale * scale_); }

  [[nodiscard]] double scale() const OSTEON_RT { return scale_; }
  [[nodiscard]] double energy_J() const OSTEON_RT { return energy_J_; }
  /// The rendered wrench: scale × field.
  [[nodiscard]] const Wrench& F_T_W() const OSTEON_RT { return F_T_W_; }

 private:
  // between ticks
  double scale_{0.0}, energy_J_{0.0};
  Wrench F_T_W_;
  Pose X_WT_{Pose::Identity()};
  bool has_pose_{false};
  // of this tick: its field, the energy without its wrench, the work of its whole wrench
  Wrench F_field_T_W_;
  double potential_J_{0.0}, energy_before_J_{0.0}, work_J_{0.0};
};

/// The greatest scale in [0, max_scale] with which `guidance` and another wrench stay within a limiter's
/// force and torque, by the closed form; 0 if the other wrench alone exceeds them.
[[nodiscard]] double ScaleWithin(const safety::WrenchLimiter& limiter, const Wrench& other,
                                 const Wrench& guidance, double max_scale) OSTEON_RT;

/// The greatest scale in [0, max_scale] that `fits`, to max_scale / 1024: found by ten halvings if max_scale
/// itself does not fit. The scales that fit must be an interval from 0; if 0 itself does not fit, the result
/// is 0.
template <class Fits>
[[nodiscard]] double MaxFittingScale(double max_scale, const Fits& fits) OSTEON_RT {
  if (!(max_scale > 0.0) || fits(max_scale)) return max_scale;
  double low = 0.0, high = max_scale;
  for (int i = 0; i < 10; ++i) {
    const double middle = 0.5 * (low + high);
    (fits(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace osteon::control
