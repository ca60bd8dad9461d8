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
  double low_hz{5.0};    ///< the band in which a hand and the arm's lag oscillate: above intended motion,
  double high_hz{40.0};  ///< and below the fastest oscillation of a lagging arm; > low_hz
  double slow_hz{1.5};   ///< intended motion lies between this and low_hz; < low_hz
  double lever_m{0.1};   ///< torques count as the force at this lever
  double floor_N{0.15};  ///< vibration of this RMS value alone makes a share of one half
  double slow_memory_s{0.2};    ///< memory of the slow energy, which must not vanish where a motion turns
  double share_low{0.3};        ///< up to this share of the energy the index tends to 0,
  double share_high{0.8};       ///< and from this share on to 1; > share_low
  double alert_index{0.25};     ///< largest index for a jolt that has not swung back yet; 0 … 1
  double alert_memory_s{0.03};  ///< memory of the band's whole energy, which raises the alert
  double rise_s{0.02};          ///< time constant of the index upward
  double decay_ratio{60.0};     ///< ratio of the time constants downward and upward; >= 1
  double max_damping_factor{100.0};  ///< factor on the law's damping at index 1; >= 1
  double max_mass_factor{1.2};       ///< factor on the law's mass and inertia at index 1; >= 1
  double notch_hz{1.5};              ///< width of each notch; 0: none
  /// Time constant of the index downward where no test has found the loop to oscillate.
  double release_s{0.1};
  ReferenceParams reference{};  ///< reference for the hand's own vibration
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const VibrationParams& params);

/// Amplitude of the oscillation in a signal: the peak of a half-wave that follows another of the opposite
/// sign within half a period of the band, with between half and ten times its size. A single jolt has no
/// second half-wave, a decaying oscillation has a smaller one, and a slow wave takes longer.
class HalfWaves {
 public:
  HalfWaves(double shortest_s, double longest_s) : shortest_s_(shortest_s), longest_s_(longest_s) {}

  /// @returns the amplitude; 0 while nothing oscillates.
  double Step(double x, double dt_s) OSTEON_RT;

 private:
  double shortest_s_, longest_s_;         ///< accepted durations of half a period
  double sign_{1.0};                      ///< sign of this half-wave
  double peak_{0.0}, since_peak_s_{0.0};  ///< this half-wave's peak so far, and the time since it
  double last_{0.0}, since_last_s_{0.0};  ///< the previous peak, and the time since it
  bool judged_{false};                    ///< this peak has passed
  double amplitude_{0.0};
};

/// Measures how much of the hand's wrench is vibration, and derives the inertia and drag that damp it.
///
/// A grip that stiffens makes an admittance-controlled arm oscillate through the arm's own lag. Neither the
/// contact model nor an observer of the virtual side's energy sees this; the sensor does:
///
///     x_b, x_s  the hand's wrench (f, t / lever) between low and high, and between slow and low
///     E_b = sum over the six axes of a^2 / 2,  a the amplitude of the oscillation in x_b (HalfWaves)
///     E_s = mean of |x_s|^2 over the last slow_memory_s,   E_a = mean of |x_b|^2 over alert_memory_s
///     E+ = max(0, E - (margin R)^2),  R the reference: the hand's own vibration (VibrationReference)
///     share(E) = E+ / (E+ + E_s + floor^2)
///     w(E) = (share(E) - share_low) / (share_high - share_low), within 0 … 1
///     S' = (w(E_b) - S) / rise_s upward, / (decay_ratio rise_s) downward;
///          while R is being found: to 1; where the hand's own was found: / release_s downward
///     A' = (alert_index w(E_a) - A) / rise_s upward, / (2 rise_s) downward
///     index I = max(S, A):   damping × (1 + I (max_damping_factor - 1)),  mass × (1 + I (max_mass_factor - 1))
///
/// Every push that begins, and every touch, has much energy in the band for some 20 ms, and drag raised by it
/// would stay for a second. The index therefore asks for two half-waves, which costs a period of delay, in
/// which a stiff clamp's oscillation grows fiftyfold. So a jolt raises an alert: some drag at once, which is
/// gone 50 ms later if nothing swings back.
///
/// With a turning spindle the cut's own forces come at multiples of its speed. Notches remove the first
/// kHarmonics of those in the band (an adaptive canceller that follows the speed; Widrow and others, Proc.
/// IEEE 63, 1975). They adapt within 1 / (pi notch_hz): a cut that begins with much ripple may count as
/// vibration for that long. An oscillation within half a notch's width of such a multiple is not seen.
///
/// The index only limits an oscillation: an oscillation has to exist for it to rise, and where the law itself
/// is unstable the index settles where the oscillation neither grows nor dies, at about floor_N. Source:
/// control.md of the design; the idea is Dimeas and Aspragathos, IEEE Trans. Haptics 9, 2016 (from memory).
class VibrationIndex {
 public:
  static constexpr int kHarmonics = 8;

  /// @throws std::invalid_argument as Validate. @param period_s > 0; a band beyond 40 % of the rate is cut
  ///   off there.
  VibrationIndex(const VibrationParams& params, double period_s);

  /// One tick. @param F  wrench of the hand, at a fixed point of the tool, in any slowly turning frame
  /// @param spindle_rad_per_s  speed of the tool; 0 if it stands
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
  struct Lines {  // the cut's forces at each harmonic: c cos + s sin
    std::array<Vector3, kHarmonics> c, s;
    Lines() { Clear(); }
    void Clear() OSTEON_RT {
      c.fill(Vector3::Zero());
      s.fill(Vector3::Zero());
    }
  };
  // Filters and energies [N²] of one part of the wrench, by axis: the force, or the torque over lever_m.
  struct Channel {
    Biquad high, low, slow_high, slow_low;
    std::array<HalfWaves, 3> waves;
    Vector3 first{Vector3::Zero()};  // the first input, which counts as zero
    Lines lines{};
    double oscillation_energy{0.0}, band_energy{0.0}, slow_energy{0.0};
  };
  void FilterChannel(Channel& channel, const Vector3& x) OSTEON_RT;
  [[nodiscard]] Vector3 RemoveSpindleLines(Lines& lines, const Vector3& x) const OSTEON_RT;
  void AdvanceSpindle(double spindle_rad_per_s) OSTEON_RT;

  VibrationParams params_;
  double period_s_;
  Channel rest_, force_, torque_;  ///< rest_: a channel at its beginning, for Reset
  bool begun_{false};
  double angle_rad_{0.0};  ///< angle of the spindle
  int from_{0}, to_{0};    ///< harmonics in the band: from_ … to_ - 1; none where equal
  std::array<double, kHarmonics> cos_{}, sin_{};  ///< of each harmonic's angle
  VibrationReference reference_;
  double seen_{0.0};   ///< index for oscillation
  double alert_{0.0};  ///< index for a possible beginning of one
};

}  // namespace osteon::control
