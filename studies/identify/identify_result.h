#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "config/reading/cell_config.h"
#include "config/reading/identified_cell.h"
#include "session/summary/verdict.h"
#include "studies/identify/excited_axis.h"
#include "studies/identify/force_fit.h"
#include "studies/identify/force_noise.h"
#include "studies/identify/hand_tremor.h"
#include "studies/identify/impedance_fit.h"
#include "studies/identify/servo_fit.h"
#include "studies/tune/tune_measured.h"

namespace osteon::studies {

/// One finding: a reason why a result is not written, or a warning for the user.
struct Finding {
  std::string where;  ///< "free run, z at 50 mm/s"
  std::string what;   ///< the value that was found, the value that is accepted, and what to do
};

/// The stiffness of the hand within one counted period of 4 s.
struct HandWindow {
  double from_s{0.0};  ///< start, in seconds of counted periods since the first counted period began
  Estimate stiffness_N_per_m{};
};

/// One axis at one speed, from one excited recording.
struct AxisResult {
  ExcitationRequest request;
  config::IdentifiedRecording recording;
  double rms_speed_m_per_s{0.0};
  /// q_meas / q_cmd; for an overlay: x / f times the arm's nominal stiffness.
  MeasuredResponse by_encoders;
  ServoFit fit;
  /// F / q_cmd / (m w^2): the tool's motion per command by the force sensor.
  std::optional<MeasuredResponse> by_force{};
  std::optional<MeasuredResponse> force_over_position{};
  std::optional<ToolForceFit> tool{};
  std::string no_tool{};  ///< why `tool` has no value
  std::optional<HandFit> hand{};
  std::optional<MeasuredResponse> force_over_command{};  ///< for a held run: F / q_cmd [N/m]
  std::vector<HandWindow> hand_windows{};                ///< the hand over time
  /// Effective mass of the arm for the hand's force; of a held run.
  std::optional<Estimate> felt_mass_kg{};
  std::optional<OverlaidArm> overlaid{};         ///< for an overlay: the arm, and the speeds of its joints
  std::optional<ImpedanceFit> overlay{};         ///< for an overlay: the fitted impedance
  std::optional<MeasuredResponse> over_force{};  ///< for an overlay: x / f in m/N
  std::optional<double> validation_chi2{};
  /// The response must be known up to this frequency; none: up to the bandwidth.
  std::optional<double> crossing_hz{};
  ExcitedSamples samples{};  ///< counts and jitter; `run` may be empty
  bool model_holds{true};    ///< false: use only the response, not the fitted model
};

/// Total lag from motion without excitation, with the hand's force as a second input: x_cmd - x_meas = lag v
/// + c F.
struct PassiveLag {
  config::IdentifiedRecording recording;
  Estimate lag_s;
  double compliance_m_per_N{0.0};         ///< compliance c; 0: no hand held the handle
  double seconds{0.0}, peak_hand_N{0.0};  ///< time in motion; largest force of the hand meanwhile
  /// Harmonics of the spindle in the force, in the direction in which they are largest; empty: the spindle
  /// turned for less than 2 s.
  std::vector<SpindleHarmonic> harmonics{};
  double spindle_hz{0.0};  ///< mean turns per second
  double notch_hz{0.0};    ///< width of the widest harmonic (MeasureNotchWidth); 0: none stands out
};

/// All results of one identification, with its findings and its verdict.
struct IdentifyResult {
  std::string cell;
  config::IdentifiedValidity valid_for;
  control::Law law{control::Law::kAdmittance};  ///< law of the cell
  double tool_mass_kg{0.0};                     ///< as the cell's file or calibration says
  std::vector<AxisResult> axes;
  /// Joints that were moved alone: response by the joint's encoder, and the fit.
  std::vector<AxisResult> joints{};
  std::optional<ForceNoise> noise{};
  std::optional<HandTremor> tremor{};
  std::vector<PassiveLag> passive{};
  std::vector<config::IdentifiedRecording> at_rest{};  ///< recordings of noise and tremor
  /// Stability margins of the cell's present gains, by the measured response.
  std::vector<TuneMargin> margins{};
  /// Nyquist plot of the hand nearest to instability; empty: there are no margins.
  std::string nyquist_svg{};
  std::vector<Finding> refused{}, warnings{};
  double data_s{0.0};       ///< total length of all recordings that were read
  double estimated_s{0.0};  ///< wall time in which they were read and estimated; 0: not timed
};

/// Name of a run, for findings: "free run, z at 50 mm/s", "free run, joint A2 at 8.6 deg/s".
[[nodiscard]] std::string NameOf(const ExcitationRequest& request);

/// Share of the messages that did not come, and of the answers that the arm did not get.
[[nodiscard]] double LossOf(const ExcitedSamples& samples);

/// If the lags at two speeds differ by more than this, relative to the larger, friction is the cause.
inline constexpr double kMaxLagApart = 0.05;

/// Judges one axis, or one joint: adds to `refused` and `warnings`, and sets model_holds.
void JudgeAxis(AxisResult& axis, IdentifyResult& result);
/// Warns if a hand held the handle in a motion without excitation: no hand can be fitted to such a motion.
void JudgePassive(IdentifyResult& result);
/// Whether the cell's present gains are stable with every hand in free air and at a wall, by the measured
/// response; true if they were not judged. Gains that are unstable only on planes as old as `osteon tune`
/// assumes give a warning, and this function still returns true.
[[nodiscard]] bool GainsStand(const IdentifyResult& result);
/// Refuses the tremor if the recording is too short, or if no hand held the handle.
void JudgeTremor(IdentifyResult& result);
/// Compares the speeds of one axis, or of one joint. Lags that differ by more than 5 % show friction; then
/// the result of the slower speed is used.
void JudgeSpeeds(IdentifyResult& result);

/// "bad" if something was refused; "look" with warnings, or if no axis was excited.
[[nodiscard]] session::Verdict Judge(const IdentifyResult& result);

/// Makes the content of identified.yaml, for `osteon tune` and other subcommands.
/// @pre nothing was refused, and an axis was measured
[[nodiscard]] config::IdentifiedCell ToIdentified(const IdentifyResult& result);

/// JSON, osteon.identify/1.
[[nodiscard]] std::string ToJson(const IdentifyResult& result, const std::string& command_line);

/// Parts of the JSON document, used for axes and joints: the arm's fit by the encoders, and the lines of a
/// response.
[[nodiscard]] nlohmann::ordered_json FitJson(const AxisResult& axis);
[[nodiscard]] nlohmann::ordered_json LinesJson(const MeasuredResponse& response, const char* by);
/// "15.00 ± 0.02 Hz, damping …": the fit of an axis or of a joint.
[[nodiscard]] std::string FitText(const AxisResult& axis);

/// Says what the user should do next.
[[nodiscard]] std::string NextStep(const IdentifyResult& result);

/// A smaller measured dead zone is taken as none: the sensor's drift has no effect.
inline constexpr double kMinDeadZone_N = 0.005;

/// The result as rows of the page and the terminal.
[[nodiscard]] std::vector<report::SummaryRow> Rows(const IdentifyResult& result);

}  // namespace osteon::studies
