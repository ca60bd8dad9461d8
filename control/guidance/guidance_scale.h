#pragma once

#include "base/marker.h"
#include "control/guidance/guidance_field.h"
#include "kinematics/spatial.h"
#include "safety/limits.h"

namespace osteon::control {

/// The scale with which the guidance is rendered, and the energy that the guidance has given to the tool.
///
/// In each tick, the scale sigma is the largest number in [0, min(gain, sigma_before + dt / 0.1 s)] with
///
///     |F_coupling + F_depth limit + sigma F| <= the cell's limit, and the arm's torques hold it
///     E_before + (F_before + sigma F)·dx / 2 + sigma U <= 0
///
/// F is the field's wrench and U its potential (GuidanceField), F_before the wrench rendered in the last
/// tick, and dx the tool's motion since then. E is the energy that the guidance has given to the tool, by the
/// trapezoidal rule; it is negative if the guidance has taken energy. The second condition means that the
/// stored energy sigma U was always taken from the hand before, whatever the limits did to sigma in between.
/// Taken energy beyond sigma U + 0.05 J is forgotten, so that it cannot be given back much later. At U = 0
/// nothing is stored, and sigma may rise at once. A guidance that is switched on outside its corridor stays
/// at sigma = 0 until the tool has been inside.
class GuidanceScale {
 public:
  /// Resets energy, scale and the last pose.
  void Reset() OSTEON_RT { *this = {}; }

  /// First half of a tick. @returns the largest scale that gain, ramp and energy allow
  /// @param max_scale  the gain, or less if the contact model is old; 0 … 1
  [[nodiscard]] double ProposeScale(const GuidanceField& field, const Pose& X_WT, double max_scale,
                                    double dt_s) OSTEON_RT;
  /// Second half of a tick: sets the scale that the limits of force and torque allow, at most the proposed
  /// one.
  void AcceptScale(double scale) OSTEON_RT;
  /// Call if a later limit multiplied the accepted wrench by this scale, 0 … 1.
  void ScaleRendered(double scale) OSTEON_RT { AcceptScale(scale * scale_); }

  [[nodiscard]] double scale() const OSTEON_RT { return scale_; }
  [[nodiscard]] double energy_J() const OSTEON_RT { return energy_J_; }
  /// The rendered wrench: scale × field.
  [[nodiscard]] const Wrench& F_T_W() const OSTEON_RT { return F_T_W_; }

 private:
  // state between ticks
  double scale_{0.0}, energy_J_{0.0};
  Wrench F_T_W_;
  Pose X_WT_{Pose::Identity()};
  bool has_pose_{false};
  // values of this tick: wrench of the field, energy without this wrench, work of this wrench at scale 1
  Wrench F_field_T_W_;
  double potential_J_{0.0}, energy_before_J_{0.0}, work_J_{0.0};
};

/// The largest scale in [0, max_scale] for which `other` + scale × `guidance` stays within a limiter's force
/// and torque, by a closed form. 0 if `other` alone exceeds them.
[[nodiscard]] double ScaleWithin(const safety::WrenchLimiter& limiter, const Wrench& other,
                                 const Wrench& guidance, double max_scale) OSTEON_RT;

/// The largest scale in [0, max_scale] for which `fits` returns true. If max_scale does not fit, ten
/// bisections find the scale to within max_scale / 1024. The fitting scales must form an interval that begins
/// at 0. If 0 does not fit, the result is 0.
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
