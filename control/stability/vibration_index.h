#pragma once

#include <algorithm>
#include <array>

#include "base/marker.h"
#include "control/stability/biquad.h"
#include "control/stability/vibration_reference.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Tuning of VibrationIndex. Every field has a usable default.
struct VibrationParams {
  bool acts{true};       ///< false: the index is computed and recorded, but changes nothing
  double low_hz{5.0};    ///< lower edge of the band in which hand and arm oscillate: above intended motion
  double high_hz{40.0};  ///< upper edge of this band; > low_hz
  double slow_hz{1.5};   ///< intended motion lies between this and low_hz; < low_hz
  double lever_m{0.1};   ///< a torque is converted to a force by this lever
  double floor_N{0.15};  ///< vibration of this RMS force without any slow motion gives share(E) = 1/2
  /// Averaging time of the slow energy: it must not vanish when a motion reverses.
  double slow_memory_s{0.2};
  double share_low{0.3};             ///< if share(E) is at most this, the index tends to 0
  double share_high{0.8};            ///< if share(E) is at least this, the index tends to 1; > share_low
  double alert_index{0.25};          ///< largest index while a jolt has no second half-wave yet; 0 … 1
  double alert_memory_s{0.03};       ///< averaging time of the band's whole energy, which raises the alert
  double rise_s{0.02};               ///< time constant of the index while it rises
  double decay_ratio{60.0};          ///< ratio of the time constants of fall and rise; >= 1
  double max_damping_factor{100.0};  ///< factor on the law's damping at index 1; >= 1
  double max_mass_factor{1.2};       ///< factor on the law's mass and inertia at index 1; >= 1
  double notch_hz{1.5};              ///< width of each notch; 0: none
  /// Time constant of the index while it falls, if the last test attributed the vibration to the hand.
  double release_s{0.1};
  ReferenceParams reference{};  ///< reference for the hand's own vibration
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const VibrationParams& params);

/// Measures the amplitude of the oscillation in a signal: the peak of a half-wave, if the previous half-wave
/// had the opposite sign, came half a period of the band earlier, and was at most twice and at least a tenth
/// as large. A single jolt has no second half-wave, the second half-wave of a decaying oscillation is
/// smaller, and a slow wave takes longer; their amplitude is 0.
class HalfWaves {
 public:
  HalfWaves(double shortest_s, double longest_s) : shortest_s_(shortest_s), longest_s_(longest_s) {}

  /// @returns the amplitude; 0 while nothing oscillates.
  double Step(double x, double dt_s) OSTEON_RT;

 private:
  double shortest_s_, longest_s_;  ///< accepted durations of half a period
  double sign_{1.0};               ///< sign of the present half-wave
  /// The present half-wave's peak so far, and the time since this peak.
  double peak_{0.0}, since_peak_s_{0.0};
  double last_{0.0}, since_last_s_{0.0};  ///< the previous half-wave's peak, and the time since that peak
  bool judged_{false};                    ///< the present peak has passed and was evaluated
  double amplitude_{0.0};
};

/// Measures how much of the hand's wrench is vibration, and derives the inertia and drag that damp it.
///
/// If the hand's grip stiffens, an admittance-controlled arm can oscillate because of its own lag. Neither
/// the contact model nor the passivity observer detects this oscillation, but the force sensor measures it:
///
///     x_b, x_s  the hand's wrench (f, t / lever), filtered to low_hz … high_hz and to slow_hz … low_hz
///     E_b = sum over the six axes of a^2 / 2,  a the amplitude of the oscillation in x_b (HalfWaves)
///     E_s = mean of |x_s|^2 over the last slow_memory_s,   E_a = mean of |x_b|^2 over alert_memory_s
///     E+ = max(0, E - (margin R)^2),  R the reference: the hand's own vibration (VibrationReference)
///     share(E) = E+ / (E+ + E_s + floor^2)
///     w(E) = (share(E) - share_low) / (share_high - share_low), within 0 … 1
///     S' = (w(E_b) - S) / rise_s while rising, / (decay_ratio rise_s) while falling;
///          during a test: w is 1; after a test that found a tremor: / release_s while falling
///     A' = (alert_index w(E_a) - A) / rise_s while rising, / (2 rise_s) while falling
///     index I = max(S, A):   damping × (1 + I (max_damping_factor - 1)),  mass × (1 + I (max_mass_factor - 1))
///
/// The beginning of every push and of every touch has much energy in the band for some 20 ms. If this energy
/// raised S, the drag would stay for a second. S therefore needs two half-waves, which takes a period of the
/// oscillation; the oscillation of a stiffly clamped handle grows fiftyfold in that time. A jolt therefore
/// raises the alert A at once. Its drag is gone 50 ms later if no second half-wave follows.
///
/// While the spindle turns, cutting forces occur at multiples of its speed. Notches remove the first
/// kHarmonics of those multiples that lie in the band (an adaptive canceller that follows the speed; Widrow
/// and others, Proc. IEEE 63, 1975). The notches adapt within 1 / (pi notch_hz). A cut that begins with much
/// ripple may be taken for vibration for that long. An oscillation within half a notch's width of a multiple
/// is not detected.
///
/// The index only limits an oscillation, because it rises only if an oscillation exists. If the law itself is
/// unstable, the oscillation settles at a constant amplitude of about floor_N. Source: control.md of the
/// design; the idea is Dimeas and Aspragathos, IEEE Trans. Haptics 9, 2016 (from memory).
class VibrationIndex {
 public:
  static constexpr int kHarmonics = 8;

  /// @throws std::invalid_argument as Validate. @param period_s > 0; the band's upper edge is lowered to 40 %
  /// of the sampling rate if it is higher.
  VibrationIndex(const VibrationParams& params, double period_s);

  /// One tick. @param F  wrench of the hand, at a fixed point of the tool, in any slowly turning frame
  /// @param spindle_rad_per_s  speed of the tool; 0 if the tool stands still
  /// @returns the index, 0 … 1; unchanged if F is not finite.
  double Step(const Wrench& F, double spindle_rad_per_s) OSTEON_RT;

  /// Returns to the state after construction.
  void Reset() OSTEON_RT;

  [[nodiscard]] double index() const OSTEON_RT { return std::max(seen_, alert_); }
  /// Factors on the law's damping and on its mass and inertia; 1 while inactive.
  [[nodiscard]] double damping_factor() const OSTEON_RT;
  [[nodiscard]] double mass_factor() const OSTEON_RT;
  /// RMS force R: vibration up to margin * R counts as the hand's own.
  [[nodiscard]] double reference_N() const OSTEON_RT { return reference_.reference_N(); }

 private:
  struct Lines {  // cutting forces at each harmonic: c cos + s sin
    std::array<Vector3, kHarmonics> c, s;
    Lines() { Clear(); }
    void Clear() OSTEON_RT {
      c.fill(Vector3::Zero());
      s.fill(Vector3::Zero());
    }
  };
  // Filters by axis, and energies [N²], of one part of the wrench: the force, or the torque divided by
  // lever_m.
  struct Channel {
    Biquad high, low, slow_high, slow_low;
    std::array<HalfWaves, 3> waves;
    Vector3 first{Vector3::Zero()};  // the first input; it is subtracted from all inputs
    Lines lines{};
    double oscillation_energy{0.0}, band_energy{0.0}, slow_energy{0.0};
  };
  void FilterChannel(Channel& channel, const Vector3& x) OSTEON_RT;
  [[nodiscard]] Vector3 RemoveSpindleLines(Lines& lines, const Vector3& x) const OSTEON_RT;
  void AdvanceSpindle(double spindle_rad_per_s) OSTEON_RT;

  VibrationParams params_;
  double period_s_;
  Channel rest_, force_, torque_;  ///< rest_: a channel in its initial state, for Reset
  bool begun_{false};
  double angle_rad_{0.0};  ///< angle of the spindle
  int from_{0}, to_{0};    ///< harmonics in the band: from_ … to_ - 1; none if the two are equal
  std::array<double, kHarmonics> cos_{}, sin_{};  ///< cosine and sine of each harmonic's angle
  VibrationReference reference_;
  double seen_{0.0};   ///< S: index of a confirmed oscillation
  double alert_{0.0};  ///< A: index of a possible beginning of an oscillation
};

}  // namespace osteon::control
