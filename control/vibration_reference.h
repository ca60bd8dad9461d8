#pragma once

#include "control/rt/marker.h"

namespace osteon::control {

/// Tuning of VibrationReference. Every field has a usable default.
struct ReferenceParams {
  double tremor_N{0.2};    ///< effective value that a hand may shake with before it is suspected; >= 0
  double margin{1.25};     ///< so many times the reference is not suspected either; >= 1
  double suspect_s{0.12};  ///< what vibrates for so long, in all, is tested
  double test_s{0.25};     ///< how long the tool is held damped
  double listen_s{0.12};   ///< the end of it, in which it is seen what is left; <= test_s
  double hold_s{0.65};     ///< how much longer where little is left: a tremor may only have beaten
  double calm_s{1.0};      ///< what has not been seen for so long is over
  double forget_s{30.0};   ///< time constant back to tremor_N from then on
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const ReferenceParams& params);

/// What vibrates in the hand and is not the loop's: the reference R, an effective value.
///
/// Force over velocity at the handle is the robot's impedance whoever shakes it, so nothing that is measured
/// tells a hand's tremor from an oscillation of the loop. A test does: with much drag on the virtual tool the
/// loop's oscillation dies, and a tremor's force stays. What vibrates beyond what is known, for suspect_s in
/// all, is tested (the index is 1 meanwhile):
///
///     before, left    the largest energy while it was suspected, and at the end of test_s
///     left >= before / 2    the hand's own: R^2 = the greater of both (and of R^2), the drag goes at once
///     else                  the loop's, or a tremor that beats: damped for hold_s more, R^2 = the largest
///                           energy seen then; where that is before / 3 or more, the hand's own
///
/// Of the loop's: watchful, R is what is left, near 0, and the drag goes slowly, until nothing vibrates
/// without it; tested again only where it vibrates much more than such a loop does. In the second after a
/// tremor was found R follows its beats up to margin * R. Later R goes back to tremor_N: down once what
/// vibrates has been less than R / margin for calm_s, up once nothing does and nothing damps.
///
/// It can't tell a jolt that would have died by itself from a loop that was calmed: watchful, too.
class VibrationReference {
 public:
  /// @throws std::invalid_argument as Validate.
  explicit VibrationReference(const ReferenceParams& params);

  /// One tick. @param swings2  energy of what swings to and fro [N^2] @param suspicion  what the index wants
  /// for what is beyond the reference, 0 … 1 @param index  what it is @param least2  energies below count as
  /// nothing
  void Step(double swings2, double suspicion, double index, double least2, double dt_s) OSTEON_RT;
  void Reset() OSTEON_RT;

  [[nodiscard]] double reference_N() const OSTEON_RT;
  /// Energy up to which nothing is vibration.
  [[nodiscard]] double allowed2() const OSTEON_RT { return params_.margin * params_.margin * reference2_; }
  /// Much drag is asked for.
  [[nodiscard]] bool testing() const OSTEON_RT { return testing_; }
  /// The last test has found the hand's own, and since its beats are known nothing has been suspected.
  [[nodiscard]] bool released() const OSTEON_RT { return released_; }

 private:
  void Judge() OSTEON_RT;

  ReferenceParams params_;
  double reference2_;          ///< R^2
  double most2_{0.0};          ///< up to which it follows beats
  double suspected_s_{0.0};    ///< time in which something vibrated
  double tested_s_{0.0};       ///< since the test began
  double since_s_{10.0};       ///< since it ended
  double calm_s_{0.0};         ///< since something vibrated
  double unconfirmed_s_{0.0};  ///< since it vibrated as R says
  double before2_{0.0}, left2_{0.0};
  bool testing_{false}, watchful_{false}, released_{false};
};

}  // namespace osteon::control
