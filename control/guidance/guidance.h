#pragma once

#include "base/marker.h"
#include "control/guidance/guidance_field.h"
#include "control/guidance/guidance_scale.h"
#include "control/tick_record.h"
#include "safety/limits.h"

namespace osteon::control {

/// Inputs of the guidance in a tick.
struct GuidanceInput {
  Pose X_WT{Pose::Identity()};  ///< tool pose: commanded (admittance) or measured (impedance)
  Twist V_WT;                   ///< velocity of T at To, in W
  double model_fade{1.0};       ///< weight of the contact model by its age, 0 … 1
};

/// One tick of the guidance along a surgical plan (a virtual fixture), for one reamer.
///
///     pose, velocity → EvaluateGuidance → GuidanceScale: gain, ramp, energy → limits (the caller's)
///                    → AcceptScale
///
/// Call ProposeScale, then AcceptScale, once per tick. At a change of tool, assign a newly constructed
/// object, whose state is at rest. Copying does not allocate.
class Guidance {
 public:
  /// @param max_speed_m_per_s  speed limit of the tool, for the check of the force's growth @param period_s >
  ///   0
  /// @throws std::invalid_argument as Validate.
  Guidance(const GuidanceParams& params, double max_speed_m_per_s, double period_s);

  /// Resets energy, scale and the spindle's stop. Call when rendering begins.
  void Reset() OSTEON_RT;
  /// Sets the gain, 0 … 1. A larger scale falls to the gain at once; a smaller scale rises to it as the
  /// energy allows.
  void SetGain(double gain) OSTEON_RT { params_.gain = gain; }

  /// @returns the largest scale that gain, age, ramp and energy allow, before the limits of force and torque
  [[nodiscard]] double ProposeScale(const GuidanceInput& input) OSTEON_RT;
  /// Sets the scale that the limits of force and torque allow.
  void AcceptScale(double scale) OSTEON_RT;
  /// Call if a later limit multiplied the rendered wrench by this scale.
  void ScaleRendered(double scale) OSTEON_RT { scale_.ScaleRendered(scale); }

  [[nodiscard]] const GuidanceParams& params() const OSTEON_RT { return params_; }
  /// The guidance at the last pose, before its scale.
  [[nodiscard]] const GuidanceField& field() const OSTEON_RT { return field_; }
  [[nodiscard]] const GuidanceScale& scale() const OSTEON_RT { return scale_; }
  /// Whether a force or torque is rendered.
  [[nodiscard]] bool acts() const OSTEON_RT { return scale_.scale() > 0.0 && !field_.inside; }
  /// Whether the spindle must stand still. True once the tool is beyond a stop, until the tool is inside the
  /// corridor again.
  [[nodiscard]] bool stops_spindle() const OSTEON_RT { return stops_spindle_; }
  /// Whether the springs' force grew faster than 1.5 sum(k) v_max in this tick, which only a defect can
  /// cause. k: stiffnesses of funnel and depth.
  [[nodiscard]] bool trips() const OSTEON_RT { return trips_; }

  /// The guidance of this tick as it is recorded.
  [[nodiscard]] GuidanceRecord Record() const OSTEON_RT;

 private:
  GuidanceParams params_;
  double period_s_;
  safety::WrenchRateTrip growth_;
  GuidanceField field_;
  GuidanceScale scale_;
  bool stops_spindle_{false}, trips_{false};
};

}  // namespace osteon::control
