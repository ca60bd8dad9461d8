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
  std::string file;  ///< its name when it was read
  std::string hash;  ///< FNV-1a of its bytes, 16 hexadecimal digits
};

/// The cell and the posture in which the figures hold.
struct IdentifiedValidity {
  std::string robot, tool;
  double period_s{0.0};
  std::array<double, 7> start_rad{};  ///< joints of the posture; the seventh of a six-axis arm is 0
  std::vector<IdentifiedRecording> recordings{};
};

/// The springs of an arm with its own impedance control, as parameters of the simulated arm (level dynamic).
struct IdentifiedImpedance {
  std::optional<double> translation_N_per_m{}, rotation_Nm_per_rad{};  ///< stiffnesses of Cartesian impedance
  std::optional<double> joint_Nm_per_rad{};  ///< of joint impedance, the same for all joints
  std::optional<double> damping_ratio{};
  bool on_mount{false};  ///< the arm was found to stand on a compliant mount
};

/// Model of the arm's motion q along one axis of the tool, at one speed, for a command q_cmd and a force F on
/// the tool:
///
///     q'' = w^2 (q_cmd(t - dead time) - q) - 2 z w q' + F / M
///
/// Under the impedance law the same model describes the response to a force that is overlaid on the arm's own
/// impedance control, which has the spring M w^2 and the damping 2 z w M.
struct IdentifiedArm {
  std::string axis;           ///< "x", "y" or "z" of the tool's frame at the posture
  double speed_m_per_s{0.0};  ///< RMS speed of the tool during the measurement
  double bandwidth_hz{0.0};   ///< w / 2 pi
  double damping_ratio{0.0};  ///< z
  /// Time from the tick that commands a motion to the first effect. Need not be a whole number of periods.
  double dead_time_s{0.0};
  double gain{1.0};                      ///< gain of the response at the lowest frequency
  double lag_s{0.0};                     ///< dead time + 2 z / w: total delay of slow motion
  std::optional<double> felt_mass_kg{};  ///< M of the model: mass that a force on the tool accelerates
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

/// Frequency response of the plant that the loop controls: the tool's motion divided by the commanded motion,
/// both along one axis. It includes the dead time: each tick's command is compared with the measurement in
/// the message that the tick answers. Under the impedance law it is the tool's motion x, divided by the
/// overlaid force f and multiplied by a spring's stiffness.
struct IdentifiedResponse {
  std::string axis;
  double speed_m_per_s{0.0};
  /// False: measured by the encoders, q_meas / q_cmd. True: measured by the force sensor as F / q_cmd / (-m
  /// s^2), with the mass m on the sensor. The latter includes the structure between encoders and tool, and
  /// the sensor's delay.
  bool by_force{false};
  /// Name of the hand that held the handle during the measurement. The response is then -F / q_cmd / (k + b s
  /// + m s^2), with the force F on the sensor and stiffness k, damping b and mass m of this hand. Empty:
  /// nobody held the handle.
  std::string hand{};
  /// Under the impedance law, the stiffness by which x / f is multiplied. If an older file does not have it,
  /// the stiffness is felt_mass_kg w^2 of the IdentifiedArm.
  std::optional<double> spring_N_per_m{};
  std::vector<IdentifiedLine> lines{};  ///< in order of rising frequency
};

struct IdentifiedSensor {
  std::optional<double> delay_s{};
  double noise_N{0.0};  ///< standard deviation of the worst component
  double drift_N{0.0};  ///< standard deviation of the means over 1 s, for the worst component
};

struct IdentifiedLink {
  double jitter_mean_s{0.0};  ///< mean delay of a message's arrival relative to the earliest possible arrival
  double jitter_p99_s{0.0};
  double loss_ratio{0.0};  ///< share of the answers that the arm did not use, 0 … 1
};

/// A resonance between encoders and tool.
struct IdentifiedResonance {
  double hz{0.0};
  double damping_ratio{0.0};
};

/// A hand on the handle as a spring, damper and mass: F = -(k + b s + m s^2) x.
struct IdentifiedHand {
  std::string name;
  double stiffness_N_per_m{0.0};
  IdentifiedInterval stiffness_interval_N_per_m{};
  double damping_Ns_per_m{0.0};
  double mass_kg{0.0};
};

struct IdentifiedVibration {
  double tremor_N{0.0};  ///< RMS force between 5 and 40 Hz of the hand at working push; 0: not measured
  /// Widths of the notches that cover the spindle's own forces. Empty: not measured.
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
