#pragma once

#include "base/marker.h"

namespace osteon::control {

/// Tuning of VibrationReference. Every field has a usable default.
struct ReferenceParams {
  double tremor_N{0.2};    ///< RMS force of a hand's tremor that is tolerated before any test; >= 0
  double margin{1.25};     ///< vibration up to this factor times the reference is tolerated; >= 1
  double suspect_s{0.12};  ///< a test starts once vibration has lasted this long in total
  double test_s{0.25};     ///< duration of a test, during which the virtual tool has high drag
  /// Length of a test's last part, in which the remaining energy is measured; <= test_s.
  double listen_s{0.12};
  double hold_s{0.65};  ///< extension of a test if little energy remains: a beating tremor may return
  double calm_s{1.0};   ///< vibration counts as ended once it has been absent for this long
  /// Time constant of the reference's return to tremor_N after the vibration has ended.
  double forget_s{30.0};
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const ReferenceParams& params);

/// Distinguishes the hand's own vibration, a tremor, from an oscillation of the loop. The result is the
/// reference R, the RMS force of the vibration that is attributed to the hand.
///
/// The ratio of force to velocity at the handle is the robot's impedance, whether hand or loop causes the
/// vibration, so measurement alone cannot distinguish the two. A test can: under high drag on the virtual
/// tool an oscillation of the loop dies out, and a tremor's force remains. Vibration beyond the reference is
/// tested once it has lasted suspect_s in total. During the test the vibration index is 1, which gives the
/// high drag.
///
///     before, left    largest oscillation energy before the test (slowly forgotten), and in its last listen_s
///     left >= before / 2    A tremor. The new R^2 is the largest of before, left and R^2. The drag
///                           is released fast.
///     left <  before / 2    The loop, or a beating tremor. The drag stays for hold_s more.
///                           The new R^2 is the largest energy in that time. The vibration was
///                           a tremor if this energy is at least before / 3.
///
/// If it was the loop, R is now near 0 and the drag is released slowly. The reference is watchful until
/// nothing vibrates and the drag is gone: while watchful, only vibration far above that of a damped loop
/// starts a new test. For one second after a tremor was found, R follows its beats up to margin * R. Later R
/// returns slowly to tremor_N: it falls once the vibration has been less than R / margin for calm_s, and
/// rises once there is neither vibration nor drag.
///
/// The test cannot distinguish a jolt that would have died out anyway from an oscillation of the loop that
/// the drag has damped. Both make the reference watchful.
class VibrationReference {
 public:
  /// @throws std::invalid_argument as Validate.
  explicit VibrationReference(const ReferenceParams& params);

  /// Advances by one tick. @param oscillation_energy  mean square of the oscillating force [N^2]
  /// @param raw_index  index that the energy beyond the reference calls for, 0 … 1
  /// @param index  present index, 0 … 1
  /// @param min_energy  energies below this count as no vibration [N^2]
  void Step(double oscillation_energy, double raw_index, double index, double min_energy,
            double dt_s) OSTEON_RT;
  void Reset() OSTEON_RT;

  [[nodiscard]] double reference_N() const OSTEON_RT;
  /// Energy that is attributed to the hand [N^2]: (margin R)^2. Only energy above it counts as vibration.
  [[nodiscard]] double allowed_energy() const OSTEON_RT {
    return params_.margin * params_.margin * reference2_;
  }
  /// Whether a test is under way, which needs high drag.
  [[nodiscard]] bool testing() const OSTEON_RT { return testing_; }
  /// Whether the last test found a tremor and no vibration beyond the reference has occurred later than one
  /// second after the test. The drag is then released fast.
  [[nodiscard]] bool attributed_to_hand() const OSTEON_RT { return attributed_to_hand_; }

 private:
  void EvaluateTest() OSTEON_RT;

  ReferenceParams params_;
  double reference2_;                 ///< R^2
  double beat_limit2_{0.0};           ///< limit up to which R^2 follows a tremor's beats
  double suspected_s_{0.0};           ///< time with vibration beyond the reference; decays slowly
  double tested_s_{0.0};              ///< time since the test began
  double since_s_{10.0};              ///< time since the last test ended
  double calm_s_{0.0};                ///< time since the last vibration of at least min_energy
  double unconfirmed_s_{0.0};         ///< time since the last vibration of at least R / margin
  double before2_{0.0}, left2_{0.0};  ///< largest energy before a test and in its measured part [N^2]
  bool testing_{false};               ///< a test is under way
  bool watchful_{false};  ///< the last test found an oscillation of the loop, or this test is extended
  bool attributed_to_hand_{false};  ///< the last test found a tremor
};

}  // namespace osteon::control
