#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

// The figures that `osteon identify` measured of a cell: arm, force sensor, link and hands. Plain data, in
// SI.

namespace osteon::config {

/// A 95 % interval.
struct IdentifiedInterval {
  double low{0.0}, high{0.0};
  [[nodiscard]] bool Contains(double value) const { return low <= value && value <= high; }
};

/// A recording that the figures come from.
struct IdentifiedRecording {
  std::string file;  ///< as it was named
  std::string hash;  ///< FNV-1a of its bytes, 16 hexadecimal digits
};

/// The cell and the posture in which the figures hold.
struct IdentifiedValidity {
  std::string robot, tool;
  double period_s{0.0};
  std::array<double, 7> start_rad{};  ///< joints of the posture; the seventh of a six-axis arm is 0
  std::vector<IdentifiedRecording> recordings{};
};

/// The springs of an arm with an impedance controller of its own, as parameters of the simulated arm (level
/// dynamic).
struct IdentifiedImpedance {
  std::optional<double> translation_N_per_m{}, rotation_Nm_per_rad{};  ///< of Cartesian impedance
  std::optional<double> joint_Nm_per_rad{};  ///< of joint impedance, all joints alike
  std::optional<double> damping_ratio{};
  bool on_mount{false};  ///< the arm was found on a mount that gives way
};

/// The arm's motion along one axis of the tool, at one speed: q'' = w^2 (q_cmd(t - dead) - q) - 2 z w q' + F
/// / M. Under the impedance law the same holds for a force that is laid over the arm's own impedance, whose
/// spring is M w^2 and whose damping 2 z w M.
struct IdentifiedArm {
  std::string axis;           ///< "x", "y" or "z" of the tool's frame at the posture
  double speed_m_per_s{0.0};  ///< RMS speed of the tool during the measurement
  double bandwidth_hz{0.0};   ///< w / 2 pi
  double damping_ratio{0.0};  ///< z
  /// From the tick that commands to its first effect; not a whole number of periods.
  double dead_time_s{0.0};
  double gain{1.0};                                ///< gain of the response at the lowest frequency
  double lag_s{0.0};                               ///< dead time + 2 z / w: total delay of slow motion
  std::optional<double> felt_mass_kg{};            ///< M, by which a force F accelerates the commanded arm
  std::optional<IdentifiedImpedance> impedance{};  ///< under the impedance law
  double chi2{0.0};                                ///< chi-squared of the fit over its degrees of freedom
  IdentifiedInterval bandwidth_interval_hz{}, damping_interval{}, dead_time_interval_s{}, lag_interval_s{};
};

/// One line of a measured frequency response.
struct IdentifiedLine {
  double hz{0.0};
  double re{0.0}, im{0.0};  ///< of the response
  double sd{0.0};           ///< standard deviation of the real part, and of the imaginary part
};

/// The plant as the loop meets it: the tool's motion for a commanded motion of 1, both along one axis. The
/// dead time is included: a tick's command against the measurement in the message that the tick answers.
/// Under the impedance law it is the motion for a force that is laid over the arm's own impedance, times a
/// spring.
struct IdentifiedResponse {
  std::string axis;
  double speed_m_per_s{0.0};
  /// False: by the encoders, q_meas / q_cmd. True: by the force sensor, F / q_cmd / (-m s^2), which includes
  /// the structure beyond the encoders and the sensor's delay.
  bool by_force{false};
  /// Name of the hand that held the handle meanwhile: the response is then -F / q_cmd / (k + b s + m s^2)
  /// with the force F on the sensor and the figures of this hand. Empty: free air.
  std::string hand{};
  /// Under the impedance law, the spring by which x / f is multiplied. Older files do not have it; the spring
  /// is then felt_mass_kg w^2 of the arm.
  std::optional<double> spring_N_per_m{};
  std::vector<IdentifiedLine> lines{};  ///< by rising frequency
};

struct IdentifiedSensor {
  std::optional<double> delay_s{};
  double noise_N{0.0};  ///< standard deviation of the worst component
  double drift_N{0.0};  ///< standard deviation of means over 1 s, of the worst component
};

struct IdentifiedLink {
  double jitter_mean_s{0.0};  ///< mean delay of the messages' arrival beyond the earliest
  double jitter_p99_s{0.0};
  double loss_ratio{0.0};  ///< share of the answers that the arm did not use, 0 … 1
};

/// A resonance between encoders and tool.
struct IdentifiedResonance {
  double hz{0.0};
  double damping_ratio{0.0};
};

/// A hand on the handle: F = -(k + b s + m s^2) x.
struct IdentifiedHand {
  std::string name;
  double stiffness_N_per_m{0.0};
  IdentifiedInterval stiffness_interval_N_per_m{};
  double damping_Ns_per_m{0.0};
  double mass_kg{0.0};
};

struct IdentifiedVibration {
  double tremor_N{0.0};  ///< RMS force between 5 and 40 Hz of the hand at working push; 0: not measured
  /// Widths of notches that contain the spindle's own forces; empty: not measured.
  std::vector<double> notch_hz{};
};

struct IdentifiedCell {
  IdentifiedValidity valid_for;
  std::vector<IdentifiedArm> arm{};
  std::vector<IdentifiedResponse> response{};
  std::optional<IdentifiedSensor> sensor{};
  std::optional<IdentifiedLink> link{};
  std::vector<IdentifiedResonance> structure{};
  std::vector<IdentifiedHand> hands{};
  std::optional<IdentifiedVibration> vibration{};
  std::optional<double> dead_zone_N{};
};

}  // namespace osteon::config
