#pragma once

#include "base/marker.h"

namespace osteon::control {

/// Tuning of VibrationReference. Every field has a usable default.
struct ReferenceParams {
  double tremor_N{0.2};    ///< effective value of a hand's shaking that is tolerated before a test; >= 0
  double margin{1.25};     ///< up to this factor on the reference vibration is tolerated; >= 1
  double suspect_s{0.12};  ///< vibration of this total duration starts a test
  double test_s{0.25};     ///< how long the tool is held damped
  double listen_s{0.12};   ///< the last part of the test, in which the remaining energy is taken; <= test_s
  double hold_s{0.65};     ///< extension of the test if little is left: a tremor may only have beaten
  double calm_s{1.0};      ///< vibration that has been absent for so long is over
  double forget_s{30.0};   ///< time constant back to tremor_N from then on
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const ReferenceParams& params);

/// Tells the hand's own vibration from an oscillation of the loop: the reference R, an effective value.
///
/// Force over velocity at the handle is the robot's impedance whoever shakes it, so no measurement alone
/// tells a hand's tremor from an oscillation of the loop. A test does: with much drag on the virtual tool the
/// loop's oscillation dies, and a tremor's force stays. Vibration beyond the reference that lasts suspect_s
/// in total is tested (the index is 1 meanwhile):
///
///     before, left    the largest energy before the test, and at the end of test_s
///     left >= before / 2    the hand's own: R^2 = the greater of both (and of R^2), the drag goes at once
///     else                  the loop's, or a tremor that beats: damped for hold_s more, R^2 = the largest
///                           energy seen then; if that is at least before / 3, the hand's own
///
/// If it is the loop's, the reference is watchful: R is what is left, near 0, and the drag goes slowly, until
/// nothing vibrates without it. A new test then needs much more vibration than such a loop has. In the second
/// after a tremor was found, R follows its beats up to margin * R. Later R returns to tremor_N: downward once
/// the vibration has been less than R / margin for calm_s, upward once there is neither vibration nor
/// damping.
///
/// The test cannot tell a jolt that would have died by itself from a calmed loop: both make it watchful.
class VibrationReference {
 public:
  /// @throws std::invalid_argument as Validate.
  explicit VibrationReference(const ReferenceParams& params);

  /// One tick. @param oscillation_energy  energy of the oscillation [N^2]
  /// @param raw_index  index wanted for the energy beyond the reference, 0 … 1  @param index  present index
  /// @param min_energy  energies below it count as nothing
  void Step(double oscillation_energy, double raw_index, double index, double min_energy,
            double dt_s) OSTEON_RT;
  void Reset() OSTEON_RT;

  [[nodiscard]] double reference_N() const OSTEON_RT;
  /// Energy up to which nothing counts as vibration.
  [[nodiscard]] double allowed_energy() const OSTEON_RT {
    return params_.margin * params_.margin * reference2_;
  }
  /// Whether a test is under way, which needs much drag.
  [[nodiscard]] bool testing() const OSTEON_RT { return testing_; }
  /// Whether the last test found the hand's own vibration, and nothing is suspected since its beats are
  /// known.
  [[nodiscard]] bool attributed_to_hand() const OSTEON_RT { return attributed_to_hand_; }

 private:
  void EvaluateTest() OSTEON_RT;

  ReferenceParams params_;
  double reference2_;          ///< R^2
  double beat_limit2_{0.0};    ///< up to which R follows beats
  double suspected_s_{0.0};    ///< time in which something vibrated
  double tested_s_{0.0};       ///< since the test began
  double since_s_{10.0};       ///< since it ended
  double calm_s_{0.0};         ///< since something vibrated
  double unconfirmed_s_{0.0};  ///< since vibration as large as R
  double before2_{0.0}, left2_{0.0};
  bool testing_{false}, watchful_{false}, attributed_to_hand_{false};
};

}  // namespace osteon::control
